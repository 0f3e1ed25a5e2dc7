"""Outlooks that are to be worked out again: asked for, claimed by one process at a time, settled once."""

from datetime import datetime
from uuid import uuid4

from sqlalchemy import ColumnElement, Update, case, delete, func, or_, select, update

from service.storage.failed import AT_FAULT
from service.storage.pending_tables import NEVER, PendingOutlookRow
from service.storage.queries.base import Queries
from service.storage.tables import UnitRow


class PendingOutlooks(Queries):
    """Of units whose history has changed."""

    def ask(self, unit: int, now: datetime) -> None:
        """Asks for a unit's outlook; what is being made of it now is made again, and what failed is tried at once."""
        new = self._upsert(PendingOutlookRow).values(unit_id=unit, asked_at=now, ticket=uuid4().hex, attempts=0)
        again = {
            "ticket": new.excluded.ticket,
            "claimed_until": case((_IS_FAILED, None), else_=PendingOutlookRow.claimed_until),
            "attempts": case((_IS_FAILED, 0), else_=PendingOutlookRow.attempts),
            "failed": None,
        }
        self._session.execute(new.on_conflict_do_update(index_elements=["unit_id"], set_=again))

    def ticket(self, serial: str) -> str | None:
        """Under which a unit's is asked for; None where it is as its history says."""
        query = select(PendingOutlookRow.ticket).join(UnitRow, UnitRow.id == PendingOutlookRow.unit_id)
        return self._session.scalar(query.where(UnitRow.serial == serial))

    def is_coming(self, serial: str) -> bool:
        """Whether a unit's is asked for and has not failed."""
        query = select(PendingOutlookRow.unit_id).join(UnitRow, UnitRow.id == PendingOutlookRow.unit_id)
        return self._session.scalar(query.where(UnitRow.serial == serial, ~_IS_FAILED)) is not None

    def failed(self, serial: str) -> str:
        """Why a unit's could not be worked out; empty where it is there, or is still being made."""
        query = select(PendingOutlookRow.failed).join(UnitRow, UnitRow.id == PendingOutlookRow.unit_id)
        return self._session.scalar(query.where(UnitRow.serial == serial)) or ""

    def waiting(self, now: datetime, limit: int) -> tuple[str, ...]:
        """Serial numbers of units that nobody is at, the one that was asked for first before all."""
        query = select(UnitRow.serial).join(PendingOutlookRow, UnitRow.id == PendingOutlookRow.unit_id)
        order = (PendingOutlookRow.asked_at, PendingOutlookRow.unit_id)
        return tuple(self._session.scalars(query.where(_is_free(now)).order_by(*order).limit(limit)))

    def claim(self, serial: str, now: datetime, until: datetime) -> int | None:
        """How often the unit was claimed, with this time, since a claim ended with a word; None where another is at
        it."""
        claimed = _of(serial).where(_is_free(now)).values(claimed_until=until, attempts=PendingOutlookRow.attempts + 1)
        return self._session.scalar(claimed.returning(PendingOutlookRow.attempts))

    def extend(self, serial: str, until: datetime) -> None:
        """Whoever claimed it is still at it."""
        self._session.execute(_of(serial).values(claimed_until=until))

    def give_back(self, serial: str) -> None:
        """Whoever was at it died: the next one may begin at once."""
        self._session.execute(_of(serial).values(claimed_until=None))

    def put_off(self, serial: str, until: datetime | None) -> None:
        """Gives a unit back after a word of why: nobody begins it before a time."""
        self._session.execute(_of(serial).values(claimed_until=until, attempts=0))

    def hold_up(self, serial: str, why: str) -> None:
        """Keeps why a try failed."""
        self._session.execute(_of(serial).values(failed=why))

    def give_up(self, serial: str) -> None:
        """No try succeeded: it is tried again when the unit's history changes, at another start, or when somebody asks
        for that."""
        why = func.coalesce(PendingOutlookRow.failed, AT_FAULT)
        self._session.execute(_of(serial).values(claimed_until=NEVER, failed=why))

    def try_again(self) -> int:
        """At a start, or when somebody asks for it: this may be another version, or a machine that has what the last
        one lacked. How many that are."""
        own = update(PendingOutlookRow).where(_IS_FAILED).values(claimed_until=None, attempts=0, failed=None)
        return len(self._session.scalars(own.returning(PendingOutlookRow.unit_id)).all())

    def holds(self, unit: int, ticket: str) -> bool:
        """Whether a unit is still asked for under a ticket; held until the transaction ends."""
        query = select(PendingOutlookRow.ticket).where(PendingOutlookRow.unit_id == unit)
        return self._session.scalar(query.with_for_update()) == ticket

    def settle(self, unit: int) -> None:
        """A unit's is as its history says."""
        self._session.execute(delete(PendingOutlookRow).where(PendingOutlookRow.unit_id == unit))


_IS_FAILED = PendingOutlookRow.failed.is_not(None)


def _of(serial: str) -> Update:
    unit = select(UnitRow.id).where(UnitRow.serial == serial).scalar_subquery()
    return update(PendingOutlookRow).where(PendingOutlookRow.unit_id == unit)


def _is_free(now: datetime) -> ColumnElement[bool]:
    return or_(PendingOutlookRow.claimed_until.is_(None), PendingOutlookRow.claimed_until <= now)
