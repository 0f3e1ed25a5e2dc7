"""Sessions as lines of a table, wherever sessions are listed."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.sessions.records import StoredSession
from service.sessions.words.conditions import Condition, condition_of, said_with


@dataclass(frozen=True)
class SessionLine:
    """One session in a list."""

    session: StoredSession
    condition: Condition


def session_lines(sessions: Sequence[StoredSession]) -> tuple[SessionLine, ...]:
    """Lines in the order of the sessions."""
    return tuple(SessionLine(session, _condition(session)) for session in sessions)


def _condition(session: StoredSession) -> Condition:
    plain = condition_of(session.verdict, is_reference=session.is_reference)
    return said_with(plain, session.reservations)
