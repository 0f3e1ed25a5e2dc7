"""Flow: one session, what was decided of its parameters, and what all sensors did together."""

from estimator.health.common_motion import CommonMotion
from service.records.decision import Decision
from service.records.session import StoredSession
from service.storage.store import Store


def session_decisions(store: Store, id: str) -> tuple[StoredSession, tuple[Decision, ...], tuple[CommonMotion, ...]]:
    """The session, its decisions and the common part of its changes, without its calibration."""
    return store.sessions.get(id), store.sessions.decisions(id), store.sessions.motions(id)
