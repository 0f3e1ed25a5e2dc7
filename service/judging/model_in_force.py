"""Step: the causes beyond the baseline that a session's calibration takes into account."""

from collections.abc import Sequence

from service.ingest.checked import Checked
from service.records.model import Model, ModelRevision
from service.storage.store import Store


def in_force(revisions: Sequence[ModelRevision]) -> tuple[ModelRevision, ...]:
    """The accepted causes that were not withdrawn since."""
    withdrawn = {r.withdraws for r in revisions}
    return tuple(r for r in revisions if r.withdraws is None and r.id not in withdrawn)


def model_as_of(revisions: Sequence[ModelRevision], number: int) -> tuple[ModelRevision, ...]:
    """The accepted causes that held when a revision was the latest."""
    return in_force([revision for revision in revisions if revision.id <= number])


def model_of(revisions: Sequence[ModelRevision]) -> Model:
    """The model that revisions add up to; the same cause on the same sensors counts once."""
    causes = dict.fromkeys((revision.cause, revision.sensors) for revision in in_force(revisions))
    return Model(max((revision.id for revision in revisions), default=0), tuple(causes))


def model_for(store: Store, new: Checked) -> Model:
    """The model for a session that is not stored yet."""
    return model_of(store.models.for_upload(new.session.unit, new.type_name, new.stand))
