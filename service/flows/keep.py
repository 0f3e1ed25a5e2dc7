"""Step: what the database keeps of a judged session under one model revision, beside what other revisions gave."""

from datetime import datetime

from service.judging.parameter_values import parameter_values
from service.records.decision import Judged
from service.records.session import StoredSession
from service.storage.store import Store


def keep(store: Store, unit: int, record: StoredSession, judged: Judged, at: datetime) -> None:
    """The calibration with its verdict, the parameters of the history, the decisions and the common motions."""
    id, revision = record.id, record.revision
    store.calibrations.add(id, revision, judged, at)
    store.history.add(unit, record, parameter_values(judged.calibration))
    store.sessions.add_decisions(id, judged.decisions, revision)
    store.sessions.add_motions(id, judged.motions, revision)
