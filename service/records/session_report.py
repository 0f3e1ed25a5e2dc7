"""Everything that is known of one session."""

from dataclasses import dataclass

from estimator.health.common_motion import CommonMotion
from estimator.results import Calibration
from service.records.decision import Decision
from service.records.diagnosis import DiagnosisSummary
from service.records.session import StoredSession
from service.records.state import StateChange


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
