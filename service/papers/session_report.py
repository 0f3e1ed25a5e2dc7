"""Everything that is known of one session."""

from dataclasses import dataclass, replace

from estimator.health.common_motion import CommonMotion
from estimator.results import Calibration
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Decision
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import DiagnosisSummary, HistoryPoint, StoredSession
from service.sessions.states import RecordKind, StateChange
from service.sessions.states_store import States
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.units.store import Units


@dataclass(frozen=True)
class SessionReport:
    """Everything a session's page or answer shows."""

    session: StoredSession
    calibration: Calibration
    """As computed at upload; `storage` rebuilds it from what it kept."""
    decisions: tuple[Decision, ...]
    motions: tuple[CommonMotion, ...] = ()
    """What all sensors did together since the reference."""
    states: tuple[StateChange, ...] = ()
    """What became of it since it was received, oldest first; empty where it was accepted and remained so."""
    diagnosis: DiagnosisSummary | None = None
    """In one line; None while it is still to be made."""
    failed: str = ""
    """Why the last try to make it failed; empty where none did."""


def session_report(store: Store, id: str) -> SessionReport:
    """The session, its calibration and its decisions."""
    session, diagnosis, failed, calibration = Calibrations(store).with_session(id)
    decisions, motions = Sessions(store).judged(id)
    states = States(store).of(RecordKind.SESSION, id)
    return SessionReport(session, calibration, decisions, motions, states, diagnosis, failed)


def recent_history(store: Store, serial: str, most: int, wanted: HistoryQuery) -> tuple[HistoryPoint, ...]:
    """The newest sessions of the wanted part of a unit's history, whole, with at most so many points; oldest first."""
    unit = Units(store).key(serial)
    found = History(store).points(unit, replace(wanted, limit=most + 1, newest=True))
    if len(found) <= most:
        return found
    return tuple(point for point in found if point.session != found[0].session)
