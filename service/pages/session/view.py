"""Filter and order of the list of sessions, in its address."""

from contextlib import suppress
from datetime import UTC, date, datetime, time, timedelta
from typing import Annotated, ClassVar

from pydantic import AfterValidator

from service.sessions.decision import Verdict
from service.sessions.records import SessionOrder, SessionQuery
from service.sessions.states import RecordState
from service.sessions.words.conditions import CONDITIONS, REFERENCE, RESERVED, STATES, UNDECIDED
from service.web.fields import Sought
from service.web.list_view import ListView, Words, one_of

VERDICTS = {condition.key: condition.word for condition in (*CONDITIONS, REFERENCE, RESERVED)}
"""Choices, in words."""
STATE_CHOICES = {state.value: word for state, word in STATES.items()}


def _day(asked: str) -> str:
    """A day as ISO 8601 writes it; empty where it is none, or the last of all days, after which no other comes."""
    with suppress(ValueError):
        return "" if date.fromisoformat(asked) == date.max else date.fromisoformat(asked).isoformat()
    return ""


Day = Annotated[Sought, AfterValidator(_day)]
"""``2026-03-01``."""


class SessionsView(ListView):
    """Sessions."""

    PATH = "/sessions"
    ORDERS: ClassVar = {
        SessionOrder.MEASURED.value: "newest measurement first",
        SessionOrder.UPLOADED.value: "last upload first",
        SessionOrder.VERDICT.value: "worst verdict first",
        SessionOrder.UNIT.value: "by serial number",
    }
    q: Words = ""
    type: Sought = ""
    stand: Sought = ""
    since: Day = ""
    """First day of measurement."""
    until: Day = ""
    """Last day of measurement."""
    state: Annotated[Sought, one_of(STATE_CHOICES)] = ""
    verdict: Annotated[Sought, one_of(VERDICTS)] = ""

    def query(self) -> SessionQuery:
        """The query to the store: one session more than fit on the page, which tells whether there are others."""
        undecided = self.verdict in (UNDECIDED.key, REFERENCE.key)
        judged = Verdict(self.verdict) if self.verdict in set(Verdict) else None
        return SessionQuery(
            text=self.q or None,
            unit_type=self.type or None,
            stand=self.stand or None,
            since=_midnight(self.since),
            until=_midnight(self.until, days=1),
            state=RecordState(self.state) if self.state else None,
            verdict=Verdict.UNDECIDABLE if undecided else judged,
            is_reference=self.verdict == REFERENCE.key if undecided else None,
            reserved=self.verdict == RESERVED.key,
            order=SessionOrder(self.order),
            backwards=self.backwards,
            after=self.after or None,
            before=self.before or None,
            limit=self.PAGE_SIZE + 1,
        )


def _midnight(day: str, days: int = 0) -> datetime | None:
    """The beginning of a day, UTC, or of one so many days later."""
    return datetime.combine(date.fromisoformat(day) + timedelta(days), time(), UTC) if day else None
