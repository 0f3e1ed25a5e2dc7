"""Step: the causes beyond the baseline that a session's calibration takes into account, and the calibration itself."""

from collections.abc import Sequence

from estimator.diagnosis.explanation.accepted import calibrate_extended
from estimator.programmes import calibrate
from estimator.results import Calibration
from estimator.session import CALIBRATIONS, CalibrationSession
from service.judging.tolerances import type_name
from service.records.model import Model, ModelRevision
from service.storage.store import Store


def in_force(revisions: Sequence[ModelRevision]) -> tuple[ModelRevision, ...]:
    """The accepted causes that were not withdrawn since."""
    withdrawn = {r.withdraws for r in revisions}
    return tuple(r for r in revisions if r.withdraws is None and r.id not in withdrawn)


def model_of(revisions: Sequence[ModelRevision]) -> Model:
    """The model that revisions add up to; the same cause on the same sensors counts once."""
    causes = dict.fromkeys((revision.cause, revision.sensors) for revision in in_force(revisions))
    return Model(max((revision.id for revision in revisions), default=0), tuple(causes))


def model_for(store: Store, session: CalibrationSession) -> Model:
    """The model for a session that is not stored yet."""
    stand = None if session.stand is None else session.stand.id
    return model_of(store.models.for_upload(session.unit, type_name(session), stand))


def calibrated(session: CalibrationSession, model: Model) -> Calibration:
    """The calibration under a model; a session that a cause of it does not show is calibrated without that cause."""
    extends = bool(model.causes) and session.programme in CALIBRATIONS
    return calibrate_extended(session, model.causes) if extends else calibrate(session)
