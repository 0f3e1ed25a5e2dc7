"""Step: what the database keeps of a session's calibration under one model revision, beside what others gave."""

from datetime import datetime

from estimator.results import Calibration
from service.judging.parameter_values import parameter_values
from service.records.decision import Judged
from service.records.session import StoredSession
from service.storage.store import Store


def keep(store: Store, unit: int, record: StoredSession, calibration: Calibration, at: datetime) -> None:
    """The calibration and the parameters of the history; what is decided of them is derived."""
    unjudged = Judged(calibration, (), record.reason, is_reference=False)
    store.calibrations.put(record.id, record.revision, unjudged, at)
    store.history.add(unit, record, parameter_values(calibration))
