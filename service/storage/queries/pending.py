"""Diagnoses that are still to be made: asked for, claimed by one process at a time, settled once."""

from collections.abc import Collection, Iterable
from datetime import datetime
from uuid import uuid4

from sqlalchemy import ColumnElement, Update, delete, func, or_, select, update

from service.records.pending import Claim, Pending
from service.storage.pending_tables import PendingRow
from service.storage.queries.base import Queries
from service.storage.tables import SessionRow


class PendingDiagnoses(Queries):
    """What is to be diagnosed, over all processes of all services on this database."""

    def add(self, sessions: Iterable[str], now: datetime) -> None:
        """Asks for diagnoses; one that is asked for already is left alone."""
        rows = [{"session_id": id, "asked_at": now, "ticket": uuid4().hex, "attempts": 0} for id in sessions]
        self.insert_all_once(PendingRow, rows)

    def look_again(self, unit: int, since: datetime, judged: Collection[str]) -> None:
        """What is being made of a unit's sessions from a date on, or of some, looks at what has changed since."""
        concerned = select(SessionRow.id).where(
            SessionRow.unit_id == unit, or_(SessionRow.started_at >= since, SessionRow.id.in_(judged))
        )
        own = update(PendingRow).where(PendingRow.session_id.in_(concerned))
        self._session.execute(own.values(ticket=uuid4().hex))

    def of(self, session: str) -> Pending | None:
        """What is known of a session's; None where none is asked for."""
        query = select(PendingRow.ticket, PendingRow.not_before).where(PendingRow.session_id == session)
        found = self._session.execute(query).one_or_none()
        return None if found is None else Pending(*found)

    def failed(self, session: str) -> str:
        """Why the last try failed; empty where none did."""
        return self._session.scalar(select(PendingRow.failed).where(PendingRow.session_id == session)) or ""

    def waiting(self, now: datetime, limit: int) -> tuple[str, ...]:
        """Sessions that nobody is at, the one that was asked for first before all."""
        due = or_(PendingRow.not_before.is_(None), PendingRow.not_before <= now)
        query = select(PendingRow.session_id).where(_is_free(now), due)
        return tuple(self._session.scalars(query.order_by(PendingRow.asked_at, PendingRow.session_id).limit(limit)))

    def count(self) -> int:
        """How many are to be made."""
        return self._session.scalar(select(func.count()).select_from(PendingRow)) or 0

    def claim(self, claim: Claim, now: datetime) -> int | None:
        """How often the session was claimed, with this time, since a claim ended with a word; None where another
        is at it, or nobody asks for it any more."""
        own = update(PendingRow).where(PendingRow.session_id == claim.session, _is_free(now))
        claimed = own.values(
            claimed_by=claim.who, claimed_until=claim.until, not_before=None, attempts=PendingRow.attempts + 1
        )
        return self._session.scalar(claimed.returning(PendingRow.attempts))

    def extend(self, claim: Claim) -> None:
        """Whoever claimed it is still at it."""
        self._session.execute(_of(claim).values(claimed_until=claim.until))

    def put_off(self, claim: Claim, until: datetime | None) -> None:
        """Gives a session back, after a word of why: nobody begins it before a time unless somebody reads it."""
        given = {"claimed_by": None, "claimed_until": None, "not_before": until, "attempts": 0}
        self._session.execute(_of(claim).values(given))

    def hold_up(self, session: str, why: str) -> None:
        """Keeps why a try failed."""
        self._session.execute(update(PendingRow).where(PendingRow.session_id == session).values(failed=why))

    def try_again(self) -> int:
        """What failed is tried at once; how many that are."""
        own = update(PendingRow).where(PendingRow.failed.is_not(None)).values(not_before=None, failed=None)
        return len(self._session.scalars(own.returning(PendingRow.session_id)).all())

    def give_back(self, claim: Claim) -> None:
        """Gives a session back whose process died: the next one may take it at once."""
        self._session.execute(_of(claim).values(claimed_by=None, claimed_until=None))

    def settle(self, session: str, ticket: str | None) -> bool:
        """Whether what was made under a ticket is of what is known now; then nobody asks for it any more.

        None: nobody had asked for it.
        """
        query = select(PendingRow.ticket).where(PendingRow.session_id == session)
        found = self._session.scalar(query.with_for_update())
        if found != ticket and found is not None:
            return False
        self._session.execute(delete(PendingRow).where(PendingRow.session_id == session))
        return True


def _is_free(now: datetime) -> ColumnElement[bool]:
    return or_(PendingRow.claimed_until.is_(None), PendingRow.claimed_until <= now)


def _of(claim: Claim) -> Update:
    return update(PendingRow).where(PendingRow.session_id == claim.session, PendingRow.claimed_by == claim.who)
