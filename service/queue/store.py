"""The queue of background work: requested, claimed by one process at a time, settled once."""

from collections.abc import Collection, Iterable
from datetime import datetime
from typing import Any
from uuid import uuid4

from sqlalchemy import (
    ColumnElement,
    Select,
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
from service.queue.records import Rank, Waiting, WorkKind, WorkState, rank_of
from service.queue.subjects_store import of_demonstration
from service.queue.tables import SINGLE, WorkRow
from service.sessions.tables import SessionRow
from service.storage.queries import Queries, Store
from service.units.tables import UnitRow

RETRY_AT_ONCE: dict[str, Any] = {"state": WorkState.WAITING, "not_before": None, "attempts": 0, "failed": None}
"""Resets failed work, so that it is attempted at once."""
_Other = aliased(WorkRow)


class PendingWork(Queries):
    """Work of all kinds that has not failed."""

    def counts(self) -> dict[WorkKind, int]:
        """Number of pieces of work to be done, by kind."""
        counted = select(WorkRow.kind, func.count(func.distinct(WorkRow.key))).where(WorkRow.failed.is_(None))
        return {WorkKind(kind): count for kind, count in self._session.execute(counted.group_by(WorkRow.kind))}

    def first(self, kinds: Iterable[WorkKind], now: datetime, limit: int, last: Rank) -> list[tuple[WorkKind, str]]:
        """Unclaimed work of some kinds that is due, in order, up to a rank."""
        query = _in_order(now).where(WorkRow.kind.in_(tuple(kinds)), WorkRow.rank <= last).limit(limit)
        return [(WorkKind(kind), key) for kind, key in self._session.execute(query)]


class WorkQueue(Queries):
    """Work of one kind, across all processes of all services on this database."""

    def __init__(self, store: Store, kind: WorkKind) -> None:
        super().__init__(store)
        self._kind = kind

    def enqueue_once(self, keys: Iterable[str], now: datetime) -> None:
        """Requests work; a request that exists is left alone."""
        self.insert_all_once(WorkRow, self._new(keys, now))

    def enqueue_again(self, key: str, now: datetime) -> None:
        """Requests work; work in progress is repeated, and failed work is attempted at once."""
        new = self._upsert(WorkRow).values(self._new((key,), now))
        changed: dict[str, Any] = {
            name: case((_HAS_FAILED, value), else_=getattr(WorkRow, name)) for name, value in RETRY_AT_ONCE.items()
        }
        changed["rank"] = case((WorkRow.rank < new.excluded.rank, WorkRow.rank), else_=new.excluded.rank)
        upsert = new.on_conflict_do_update(
            index_elements=["kind", "key"], index_where=SINGLE, set_={"ticket": new.excluded.ticket, **changed}
        )
        self._session.execute(upsert)

    def enqueue_each(self, keys: Iterable[str], now: datetime) -> None:
        """Requests work in additional rows, also where it is requested already; failed work is attempted at once."""
        rows = self._new(keys, now)
        if rows:
            self._session.execute(insert(WorkRow), rows)
        for row in rows:
            self._session.execute(self._of(row["key"]).where(_HAS_FAILED).values(**RETRY_AT_ONCE))

    def get(self, key: str) -> Waiting | None:
        """A piece of pending work; None where there is no request."""
        query = select(WorkRow.ticket, WorkRow.not_before, WorkRow.failed, WorkRow.rank).where(*self._is(key))
        row = self._session.execute(query.order_by(WorkRow.failed.is_(None), WorkRow.id)).first()
        return None if row is None else Waiting(row[0], row[1], row[2] or "", Rank(row[3]))

    def failed(self, key: str) -> str:
        """Reason of the last failed attempt; empty where none failed."""
        waiting = self.get(key)
        return "" if waiting is None else waiting.failed

    def is_pending(self, key: str) -> bool:
        """Whether it is requested and has not failed."""
        waiting = self.get(key)
        return waiting is not None and not waiting.failed

    def tickets(self, key: str) -> tuple[str, ...]:
        """Tickets of a piece of work: read before its input."""
        return tuple(self._session.scalars(select(WorkRow.ticket).where(*self._is(key))))

    def tickets_under(self, prefix: str) -> tuple[str, ...]:
        """Tickets of all work whose key has a prefix."""
        conditions = (WorkRow.kind == self._kind, WorkRow.key.startswith(prefix, autoescape=True))
        return tuple(self._session.scalars(select(WorkRow.ticket).where(*conditions)))

    def any_pending(self) -> bool:
        """Whether any is requested that has not failed."""
        query = select(WorkRow.id).where(WorkRow.kind == self._kind, WorkRow.failed.is_(None)).limit(1)
        return self._session.scalar(query) is not None

    def count(self) -> int:
        """Number of pending pieces."""
        query = select(func.count()).select_from(WorkRow).where(WorkRow.kind == self._kind)
        return self._session.scalar(query) or 0

    def waiting(self, now: datetime, limit: int) -> tuple[str, ...]:
        """Unclaimed work that is due, in order."""
        query = _in_order(now).where(WorkRow.kind == self._kind).limit(limit)
        return tuple(key for _, key in self._session.execute(query))

    def hurry(self, *keys: str) -> None:
        """Puts pieces before all that nobody waits for: somebody looks at them."""
        pieces = update(WorkRow).where(WorkRow.kind == self._kind, WorkRow.key.in_(keys))
        self._session.execute(pieces.where(WorkRow.rank > Rank.AWAITED).values(rank=Rank.AWAITED))

    def claim(self, key: str, now: datetime, until: datetime) -> int | None:
        """Leases a piece of work; the number of leases since an attempt ended with an answer. None where another
        process has it, or it is no longer requested."""
        available = self._of(key).where(_is_free(now), WorkRow.state == WorkState.WAITING)
        claimed = available.values(lease_until=until, not_before=None, attempts=WorkRow.attempts + 1)
        return max(self._session.scalars(claimed.returning(WorkRow.attempts)).all(), default=None)

    def extend(self, key: str, until: datetime) -> None:
        """Extends the lease."""
        self._session.execute(self._of(key).where(WorkRow.lease_until.is_not(None)).values(lease_until=until))

    def give_back(self, key: str, now: datetime) -> None:
        """Ends a lease after a failure of the program or a dead process: it may be claimed at once, behind what waits
        already."""
        self._session.execute(self._of(key).values(lease_until=None, asked_at=now))

    def requeue(self, key: str, now: datetime) -> None:
        """Ends a lease after one piece of several: the next one waits behind what waits already."""
        self._session.execute(self._of(key).values(lease_until=None, asked_at=now, attempts=0, failed=None))

    def put_off(self, key: str, until: datetime | None) -> None:
        """Ends a lease after an attempt that failed with a reason: not claimed before a time, unless a reader requests
        it."""
        self._session.execute(self._of(key).values(lease_until=None, not_before=until, attempts=0))

    def record_failure(self, key: str, why: str) -> None:
        """Records why an attempt failed."""
        self._touch(key)
        self._session.execute(self._of(key).values(failed=why))

    def give_up(self, key: str, why: str | None = None) -> None:
        """Gives up after the last attempt: attempted again on a new request, at the next start, or by an explicit
        retry."""
        self._touch(key)
        reason = why or func.coalesce(WorkRow.failed, AT_FAULT)
        self._session.execute(self._of(key).values(state=WorkState.FAILED, lease_until=None, failed=reason))

    def _touch(self, key: str) -> None:
        """Marks the unit that the work is about: its use says that something failed."""
        if self._kind is WorkKind.DIAGNOSIS:
            self.touch(*self._session.scalars(select(SessionRow.unit_id).where(SessionRow.id == key)))
        elif self._kind in (WorkKind.OUTLOOK, WorkKind.DERIVATION):
            self.touch(*self._session.scalars(select(UnitRow.id).where(UnitRow.serial == key)))

    def add_failed(self, key: str, why: str, now: datetime) -> None:
        """Records the failure of work that is not claimed here."""
        self.enqueue_once((key,), now)
        self.give_up(key, why)

    def reset_attempts(self, key: str) -> None:
        """Resets the count of attempts: the dead process had another cause, which is known now."""
        self._session.execute(self._of(key).values(attempts=0))

    def holds(self, key: str, ticket: str | None) -> bool:
        """Whether a piece of work is still requested under a ticket; locks it until the transaction ends."""
        return self._session.scalar(select(WorkRow.ticket).where(*self._is(key)).with_for_update()) == ticket

    def settle(self, key: str, ticket: str | None) -> bool:
        """Whether a result made under a ticket is current; then the request is removed.

        None: there was no request.
        """
        current = self._session.scalar(select(WorkRow.ticket).where(*self._is(key)).with_for_update())
        if current != ticket and current is not None:
            return False
        self.drop(key)
        return True

    def settle_each(self, tickets: Collection[str]) -> None:
        """Removes answered requests; later ones stay."""
        conditions = (WorkRow.kind == self._kind, WorkRow.ticket.in_(tuple(tickets)))
        self._session.execute(delete(WorkRow).where(*conditions))

    def drop(self, *keys: str) -> None:
        """Removes requests."""
        self._session.execute(delete(WorkRow).where(WorkRow.kind == self._kind, WorkRow.key.in_(keys)))

    def drop_free(self, keys: Iterable[str], now: datetime) -> tuple[str, ...]:
        """Removes unclaimed requests, and returns their keys."""
        conditions = (WorkRow.kind == self._kind, WorkRow.key.in_(tuple(keys)), _is_free(now))
        return tuple(self._session.scalars(delete(WorkRow).where(*conditions).returning(WorkRow.key)))

    def _new(self, keys: Iterable[str], now: datetime) -> list[dict[str, Any]]:
        wanted = tuple(keys)
        shown = of_demonstration(self._session, self._kind, wanted)
        return [
            {
                "kind": self._kind, "key": key, "asked_at": now, "ticket": uuid4().hex, "state": WorkState.WAITING,
                "attempts": 0, "rank": rank_of(self._kind, is_demonstration=key in shown),
            }
            for key in wanted
        ]  # fmt: skip

    def _is(self, key: str) -> tuple[ColumnElement[bool], ColumnElement[bool]]:
        return WorkRow.kind == self._kind, WorkRow.key == key

    def _of(self, key: str) -> Update:
        return update(WorkRow).where(*self._is(key))


_HAS_FAILED = WorkRow.failed.is_not(None)


def _in_order(now: datetime) -> Select[str, str]:
    """Unclaimed work that is due, a row a piece: by rank, then the oldest request first."""
    same_work = (_Other.kind == WorkRow.kind, _Other.key == WorkRow.key)
    is_blocked = or_(_Other.lease_until > now, _Other.not_before > now, _Other.state == WorkState.FAILED)
    is_before = or_(_Other.rank < WorkRow.rank, and_(_Other.rank == WorkRow.rank, _Other.id < WorkRow.id))
    is_first = ~exists().where(*same_work, or_(is_blocked, is_before))
    return select(WorkRow.kind, WorkRow.key).where(is_first).order_by(WorkRow.rank, WorkRow.asked_at, WorkRow.id)


def _is_free(now: datetime) -> ColumnElement[bool]:
    return or_(WorkRow.lease_until.is_(None), WorkRow.lease_until <= now)


def is_due(now: datetime) -> ColumnElement[bool]:
    """Whether a row is unclaimed and its next attempt is due."""
    return and_(_is_free(now), or_(WorkRow.not_before.is_(None), WorkRow.not_before <= now))


def work_of(kind: WorkKind, number: InstrumentedAttribute[int]) -> ColumnElement[bool]:
    """Joins the work of a record whose number is the key."""
    return and_(WorkRow.kind == kind, WorkRow.key == cast(number, String))
