"""Step: the causes beyond the baseline that a session's calibration takes into account."""

from collections.abc import Iterator, Sequence
from datetime import UTC, datetime

from estimator.groups.fixed import FixedEffect, in_one_session
from estimator.groups.layout import EVERY
from estimator.moments import moment
from estimator.results import SensorCalibration
from service.ingest.checked import Checked
from service.models.records import Evidence, Model, ModelRevision, Pooled, Scope
from service.models.store import Models
from service.storage.queries import Store

EVER = datetime.min.replace(tzinfo=UTC)
NARROWEST = (Scope.UNIT, Scope.UNIT_TYPE, Scope.STAND)
"""Of one cause on one sensor the size found nearest to it counts: every group is pooled on the plain simulation, so
each of them holds the whole effect."""


def in_force(revisions: Sequence[ModelRevision]) -> tuple[ModelRevision, ...]:
    """The accepted causes that were not withdrawn since."""
    withdrawn = {r.withdraws for r in revisions}
    return tuple(r for r in revisions if r.withdraws is None and r.id not in withdrawn)


def model_as_of(revisions: Sequence[ModelRevision], number: int) -> tuple[ModelRevision, ...]:
    """The accepted causes that held when a revision was the latest."""
    return in_force([revision for revision in revisions if revision.id <= number])


def model_of(revisions: Sequence[ModelRevision], at: datetime) -> Model:
    """The model that revisions add up to for a session of a time; the same cause on the same sensors counts once."""
    holding = in_force(revisions)
    causes = dict.fromkeys((r.cause, r.sensors) for r in holding if pooled_of(r) is None)
    nearest = sorted(holding, key=lambda r: (NARROWEST.index(r.scope), -r.id))
    return Model(max((r.id for r in revisions), default=0), tuple(causes), tuple(_fixed(nearest, at)))


def model_for(store: Store, new: Checked) -> Model:
    """The model for a session that is not stored yet."""
    return model_of(Models(store).for_upload(new.session.unit, new.type_name, new.stand), new.measured_at)


def pooled_of(revision: ModelRevision) -> Pooled | None:
    """What a group told of a revision's cause; None where a single session showed it."""
    return None if revision.evidence is None else revision.evidence.pooled


def places_of(revision: ModelRevision, sensors: Sequence[SensorCalibration]) -> tuple[str, ...]:
    """The sensors of a block that a revision's cause acts on, by name; an empty name for one of stand or fixture."""
    pooled = pooled_of(revision)
    if EVERY in revision.sensors and pooled is not None:
        return tuple(sensor.name for sensor in sensors if sensor.kind == pooled.kind)
    return revision.sensors or ("",)


def _fixed(revisions: Sequence[ModelRevision], at: datetime) -> Iterator[FixedEffect]:
    """Of what groups showed; what began at a date is not in the sessions before it."""
    for revision in revisions:
        evidence, pooled = revision.evidence, pooled_of(revision)
        if evidence is not None and pooled is not None and at >= _began(revision, pooled):
            yield _effect(revision, evidence, pooled)


def _effect(revision: ModelRevision, evidence: Evidence, pooled: Pooled) -> FixedEffect:
    return FixedEffect(
        cause=revision.cause,
        sensors=revision.sensors,
        kind=pooled.kind,
        amplitude=evidence.amplitude,
        sigma=in_one_session(evidence.sigma, pooled.spread),
        shape=pooled.shape,
        varies=pooled.form == "varying",
        words=pooled.words,
    )


def _began(revision: ModelRevision, pooled: Pooled) -> datetime:
    """From when on sessions have it; where earlier versions did not know, those after its acceptance surely do."""
    if pooled.form != "since":
        return EVER
    return revision.accepted_at if pooled.since is None else moment(pooled.since)
