"""The queue of work beside the requests: asked for, claimed by one process at a time, settled once."""

from collections.abc import Collection, Iterable
from datetime import datetime
from typing import Any
from uuid import uuid4

from sqlalchemy import (
    ColumnElement,
    String,
    Update,
    and_,
    case,
    cast,
    delete,
    exists,
    func,
    insert,
    or_,
    select,
    update,
)
from sqlalchemy.orm import InstrumentedAttribute, aliased

from service.kit.failure import AT_FAULT
from service.queue.records import Waiting, WorkKind, WorkState
from service.queue.tables import SINGLE, WorkRow
from service.storage.queries import Queries, Store

ANEW: dict[str, Any] = {"state": WorkState.WAITING, "not_before": None, "attempts": 0, "failed": None}
"""Of work that failed, and is tried at once."""
_Other = aliased(WorkRow)


class PendingWork(Queries):
    """Work of all kinds that has not failed."""

    def counts(self) -> dict[WorkKind, int]:
        """How much of each kind is to be done."""
        counted = select(WorkRow.kind, func.count(func.distinct(WorkRow.key))).where(WorkRow.failed.is_(None))
        return {WorkKind(kind): count for kind, count in self._session.execute(counted.group_by(WorkRow.kind))}


class WorkQueue(Queries):
    """Work of one kind, over all processes of all services on this database."""

    def __init__(self, store: Store, kind: WorkKind) -> None:
        super().__init__(store)
        self._kind = kind

    def ask_once(self, keys: Iterable[str], now: datetime) -> None:
        """Asks for work; what is asked for already is left alone."""
        self.insert_all_once(WorkRow, [self._new(key, now) for key in keys])

    def ask_again(self, key: str, now: datetime) -> None:
        """Asks for work; what is being made now is made again, and what failed is tried at once."""
        new = self._upsert(WorkRow).values(**self._new(key, now))
        anew = {name: case((_HAS_FAILED, value), else_=getattr(WorkRow, name)) for name, value in ANEW.items()}
        again = new.on_conflict_do_update(
            index_elements=["kind", "key"], index_where=SINGLE, set_={"ticket": new.excluded.ticket, **anew}
        )
        self._session.execute(again)

    def ask_each(self, keys: Iterable[str], now: datetime) -> None:
        """Asks in rows of their own, also for what is asked for already; what failed is tried at once."""
        rows = [self._new(key, now) for key in keys]
        if rows:
            self._session.execute(insert(WorkRow), rows)
        for row in rows:
            self._session.execute(self._of(row["key"]).where(_HAS_FAILED).values(**ANEW))

    def get(self, key: str) -> Waiting | None:
        """What is known of a piece of work; None where nobody asks for it."""
        query = select(WorkRow.ticket, WorkRow.not_before, WorkRow.failed).where(*self._is(key))
        found = self._session.execute(query.order_by(WorkRow.failed.is_(None), WorkRow.id)).first()
        return None if found is None else Waiting(found[0], found[1], found[2] or "")

    def failed(self, key: str) -> str:
        """Why the last try failed; empty where none did."""
        found = self.get(key)
        return "" if found is None else found.failed

    def is_coming(self, key: str) -> bool:
        """Whether it is asked for and has not failed."""
        found = self.get(key)
        return found is not None and not found.failed

    def tickets(self, key: str) -> tuple[str, ...]:
        """Under which a piece of work is asked for: read before what it rests on."""
        return tuple(self._session.scalars(select(WorkRow.ticket).where(*self._is(key))))

    def tickets_under(self, start: str) -> tuple[str, ...]:
        """The same of all work whose key starts so."""
        own = (WorkRow.kind == self._kind, WorkRow.key.startswith(start, autoescape=True))
        return tuple(self._session.scalars(select(WorkRow.ticket).where(*own)))

    def count(self) -> int:
        """How much of it is to be done."""
        query = select(func.count()).select_from(WorkRow).where(WorkRow.kind == self._kind)
        return self._session.scalar(query) or 0

    def waiting(self, now: datetime, limit: int) -> tuple[str, ...]:
        """What nobody is at and is due, the one that was asked for first before all."""
        same = (_Other.kind == WorkRow.kind, _Other.key == WorkRow.key)
        hindered = or_(_Other.lease_until > now, _Other.not_before > now, _Other.state == WorkState.FAILED)
        is_first = ~exists().where(*same, or_(hindered, _Other.id < WorkRow.id))
        query = select(WorkRow.key).where(WorkRow.kind == self._kind, is_first)
        return tuple(self._session.scalars(query.order_by(WorkRow.asked_at, WorkRow.id).limit(limit)))

    def claim(self, key: str, now: datetime, until: datetime) -> int | None:
        """Leases a piece of work; how often that was done, with this time, since a try ended with an answer. None
        where another is at it, or nobody asks for it any more."""
        own = self._of(key).where(_is_free(now), WorkRow.state == WorkState.WAITING)
        claimed = own.values(lease_until=until, not_before=None, attempts=WorkRow.attempts + 1)
        return max(self._session.scalars(claimed.returning(WorkRow.attempts)).all(), default=None)

    def extend(self, key: str, until: datetime) -> None:
        """Whoever claimed it is still at it."""
        self._session.execute(self._of(key).where(WorkRow.lease_until.is_not(None)).values(lease_until=until))

    def give_back(self, key: str, now: datetime) -> None:
        """The program failed at it or its process died: it may begin again at once, behind what waits already."""
        self._session.execute(self._of(key).values(lease_until=None, asked_at=now))

    def next_turn(self, key: str, now: datetime) -> None:
        """One piece of several is done: the next one waits behind what waits already."""
        self._session.execute(self._of(key).values(lease_until=None, asked_at=now, attempts=0, failed=None))

    def put_off(self, key: str, until: datetime | None) -> None:
        """Ends a lease after a try that says why: nobody begins it before a time unless somebody reads it."""
        self._session.execute(self._of(key).values(lease_until=None, not_before=until, attempts=0))

    def hold_up(self, key: str, why: str) -> None:
        """Keeps why a try failed."""
        self._session.execute(self._of(key).values(failed=why))

    def give_up(self, key: str, why: str | None = None) -> None:
        """No try succeeded: it is tried again when it is asked for anew, at another start, or by whoever wants that."""
        reason = why or func.coalesce(WorkRow.failed, AT_FAULT)
        self._session.execute(self._of(key).values(state=WorkState.FAILED, lease_until=None, failed=reason))

    def keep_failed(self, key: str, why: str, now: datetime) -> None:
        """Keeps why work failed that is not claimed here."""
        self.ask_once((key,), now)
        self.give_up(key, why)

    def forgive(self, key: str) -> None:
        """What died was at fault for another reason that is known now: attempts are counted anew."""
        self._session.execute(self._of(key).values(attempts=0))

    def holds(self, key: str, ticket: str | None) -> bool:
        """Whether a piece of work is still asked for under a ticket; held until the transaction ends."""
        return self._session.scalar(select(WorkRow.ticket).where(*self._is(key)).with_for_update()) == ticket

    def settle(self, key: str, ticket: str | None) -> bool:
        """Whether what was made under a ticket is of what is known now; then nobody asks for it any more.

        None: nobody had asked for it.
        """
        found = self._session.scalar(select(WorkRow.ticket).where(*self._is(key)).with_for_update())
        if found != ticket and found is not None:
            return False
        self.drop(key)
        return True

    def settle_each(self, tickets: Collection[str]) -> None:
        """Who asked has the answer; whoever asked since has not."""
        own = (WorkRow.kind == self._kind, WorkRow.ticket.in_(tuple(tickets)))
        self._session.execute(delete(WorkRow).where(*own))

    def drop(self, *keys: str) -> None:
        """Nobody asks for it any more."""
        self._session.execute(delete(WorkRow).where(WorkRow.kind == self._kind, WorkRow.key.in_(keys)))

    def drop_free(self, keys: Iterable[str], now: datetime) -> tuple[str, ...]:
        """The same of what nobody is at; which those are."""
        free = (WorkRow.kind == self._kind, WorkRow.key.in_(tuple(keys)), _is_free(now))
        return tuple(self._session.scalars(delete(WorkRow).where(*free).returning(WorkRow.key)))

    def _new(self, key: str, now: datetime) -> dict[str, Any]:
        return {
            "kind": self._kind, "key": key, "asked_at": now, "ticket": uuid4().hex, "state": WorkState.WAITING,
            "attempts": 0,
        }  # fmt: skip

    def _is(self, key: str) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
        return WorkRow.kind == self._kind, WorkRow.key == key

    def _of(self, key: str) -> Update:
        return update(WorkRow).where(*self._is(key))


_HAS_FAILED = WorkRow.failed.is_not(None)


def _is_free(now: datetime) -> ColumnElement[bool]:
    return or_(WorkRow.lease_until.is_(None), WorkRow.lease_until <= now)


def is_due(now: datetime) -> ColumnElement[bool]:
    """Whether nobody is at a row and its next try is due."""
    return and_(_is_free(now), or_(WorkRow.not_before.is_(None), WorkRow.not_before <= now))


def work_of(kind: WorkKind, number: InstrumentedAttribute[int]) -> ColumnElement[bool]:
    """Joins the work of a record that has a number; its key is that number."""
    return and_(WorkRow.kind == kind, WorkRow.key == cast(number, String))
