"""What a visitor of the list of sessions asked to see."""

from contextlib import suppress
from dataclasses import dataclass
from datetime import UTC, date, datetime, time, timedelta

from pydantic import BaseModel

from service.sessions.decision import Verdict
from service.sessions.records import SessionOrder, SessionQuery
from service.sessions.states import RecordState
from service.sessions.words.conditions import CONDITIONS, REFERENCE, RESERVED, STATES, UNDECIDED
from service.web.list_view import Asked, ListView, known_order

PAGE_SIZE = 50
"""Sessions on a page: two screens."""
ORDERS: dict[str, str] = {
    SessionOrder.MEASURED.value: "newest measurement first",
    SessionOrder.UPLOADED.value: "last upload first",
    SessionOrder.VERDICT.value: "worst verdict first",
    SessionOrder.UNIT.value: "by serial number",
}
VERDICTS = {condition.key: condition.word for condition in (*CONDITIONS, REFERENCE, RESERVED)}
"""Choices, in words."""
STATE_CHOICES = {state.value: word for state, word in STATES.items()}
NAMES = {
    "text": "q", "unit_type": "type", "stand": "stand", "since": "since", "until": "until", "state": "state",
    "verdict": "verdict", "sort": "sort", "after": "after", "before": "before",
}  # fmt: skip
"""Fields of a view as they are called in an address."""
PLAIN = {"sort": SessionOrder.MEASURED.value}
"""What an address need not say."""
FIRST = {"after": "", "before": ""}
"""What leads to the first page."""


class SessionsAsked(BaseModel):
    """An address as it came."""

    q: Asked = ""
    type: Asked = ""
    stand: Asked = ""
    since: Asked = ""
    until: Asked = ""
    state: Asked = ""
    verdict: Asked = ""
    sort: Asked = ""
    after: Asked = ""
    before: Asked = ""


@dataclass(frozen=True)
class SessionsView(ListView):
    """Sessions."""

    PATH = "/sessions"
    NAMES = NAMES
    PLAIN = PLAIN
    FIRST = FIRST
    ORDERS = ORDERS
    sort: str = SessionOrder.MEASURED.value
    text: str = ""
    unit_type: str = ""
    stand: str = ""
    since: str = ""
    """First day of measurement, ``2026-03-01``."""
    until: str = ""
    """Last day of measurement."""
    state: str = ""
    verdict: str = ""
    after: str = ""
    """The session that this page follows."""
    before: str = ""
    """The session that it comes before."""

    @classmethod
    def of(cls, asked: SessionsAsked) -> "SessionsView":
        """The view of an address; what it asks that nobody knows is left out."""
        return cls(
            sort=known_order(asked.sort, ORDERS, SessionOrder.MEASURED.value),
            text=asked.q.strip(),
            unit_type=asked.type,
            stand=asked.stand,
            since=_day(asked.since),
            until=_day(asked.until),
            state=asked.state if asked.state in set(RecordState) else "",
            verdict=asked.verdict if asked.verdict in VERDICTS else "",
            after=asked.after,
            before="" if asked.after else asked.before,
        )

    def query(self) -> SessionQuery:
        """What the store is asked: one session more than fit on the page, which says whether there are others."""
        undecided = self.verdict in (UNDECIDED.key, REFERENCE.key)
        judged = Verdict(self.verdict) if self.verdict in set(Verdict) else None
        return SessionQuery(
            text=self.text or None,
            unit_type=self.unit_type or None,
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
            limit=PAGE_SIZE + 1,
        )


def _day(asked: str) -> str:
    """A day as ISO 8601 writes it; empty where it is none, or the last of all days, after which no other comes."""
    with suppress(ValueError):
        return "" if date.fromisoformat(asked) == date.max else date.fromisoformat(asked).isoformat()
    return ""


def _midnight(day: str, days: int = 0) -> datetime | None:
    """The beginning of a day, UTC, or of one so many days later."""
    return datetime.combine(date.fromisoformat(day) + timedelta(days), time(), UTC) if day else None
