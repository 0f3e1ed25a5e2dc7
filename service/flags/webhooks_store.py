"""Addresses that are notified, and the outbox of messages to them."""

from collections.abc import Collection
from dataclasses import replace
from datetime import datetime

from sqlalchemy import ColumnElement, func, select, update

from service.errors import NotFoundError
from service.flags.records import Delivery, DeliveryState, Matter, Outgoing, Webhook
from service.flags.store import notice_of
from service.flags.tables import DeliveryRow, FlagRow, NoticeRow, WebhookRow
from service.kit.copying import copied
from service.queue.records import WorkKind
from service.queue.store import WorkQueue, is_due, work_of
from service.queue.tables import WorkRow
from service.storage.queries import Queries
from service.units.tables import UnitRow

REMOVED = "the webhook was removed"
"""The outcome of deliveries that then still waited."""


class Webhooks(Queries):
    """Webhooks and their deliveries."""

    def add(self, url: str, secret: str, who: str, now: datetime) -> Webhook:
        """Stores an address; it is notified of what happens from now on."""
        row = WebhookRow(url=url, secret=secret, who=who, created_at=now, removed_at=None)
        self._session.add(row)
        self._session.flush()
        return _webhook(row)

    def get(self, id: int) -> Webhook:
        """One address that was not removed."""
        row = self._session.scalar(select(WebhookRow).where(WebhookRow.id == id, WebhookRow.removed_at.is_(None)))
        if row is None:
            raise NotFoundError("There is no webhook {id}.", id=id)
        return _webhook(row)

    def every(self) -> tuple[Webhook, ...]:
        """All addresses that were not removed."""
        query = select(WebhookRow).where(WebhookRow.removed_at.is_(None)).order_by(WebhookRow.id)
        return tuple(map(_webhook, self._session.scalars(query)))

    def remove(self, id: int, now: datetime) -> None:
        """Stops notifying an address; what was on its way is given up."""
        self._session.execute(update(WebhookRow).where(WebhookRow.id == id).values(removed_at=now))
        waiting = update(DeliveryRow).where(DeliveryRow.webhook_id == id, DeliveryRow.state == DeliveryState.WAITING)
        failed = waiting.values(state=DeliveryState.FAILED, outcome=REMOVED, ended_at=now)
        self._queue.drop(*map(str, self._session.scalars(failed.returning(DeliveryRow.id))))

    def deliveries(self, id: int, limit: int) -> tuple[Delivery, ...]:
        """The latest deliveries to an address, newest first."""
        next_at = func.coalesce(DeliveryRow.ended_at, WorkRow.lease_until, WorkRow.not_before, WorkRow.asked_at)
        query = (
            select(DeliveryRow, NoticeRow, UnitRow.serial, next_at)
            .outerjoin(WorkRow, _WORK)
            .join(NoticeRow, NoticeRow.id == DeliveryRow.notice_id)
            .join(UnitRow, UnitRow.id == NoticeRow.unit_id)
            .where(DeliveryRow.webhook_id == id)
            .order_by(DeliveryRow.id.desc())
        )
        return tuple(
            Delivery(
                id=row.id,
                notice=notice_of(notice, serial),
                state=DeliveryState(row.state),
                attempts=row.attempts,
                next_at=at,
                outcome=row.outcome,
            )
            for row, notice, serial, at in self._session.execute(query.limit(limit))
        )

    def is_due(self, now: datetime, but: Collection[int] = ()) -> bool:
        """Whether anything in the outbox is due, but for some webhooks; asked without keeping writers waiting."""
        return (
            self._session.scalar(select(DeliveryRow.id).join(WorkRow, _WORK).where(*_due(now, but)).limit(1))
            is not None
        )

    def claim(self, now: datetime, until: datetime, limit: int, but: Collection[int] = ()) -> tuple[Outgoing, ...]:
        """The due messages, oldest first, except for some webhooks; claimed until a time: nobody else sends them
        before, and then somebody does.
        """
        query = (
            select(DeliveryRow, WebhookRow, NoticeRow, UnitRow.serial, FlagRow)
            .join(WorkRow, _WORK)
            .join(WebhookRow, WebhookRow.id == DeliveryRow.webhook_id)
            .join(NoticeRow, NoticeRow.id == DeliveryRow.notice_id)
            .join(UnitRow, UnitRow.id == NoticeRow.unit_id)
            .outerjoin(FlagRow, FlagRow.id == NoticeRow.flag_id)
            .where(*_due(now, but))
            .order_by(DeliveryRow.id)
            .limit(limit)
            .with_for_update(of=DeliveryRow, skip_locked=True)
        )
        claimed = []
        for row, webhook, notice, serial, flag in self._session.execute(query):
            if self._queue.claim(str(row.id), now, until) is None:
                continue
            row.attempts += 1
            found = Outgoing(row.id, row.attempts, _webhook(webhook), notice_of(notice, serial), None, "")
            claimed.append(found if flag is None else replace(found, matter=Matter(flag.matter), place=flag.place))
        self._session.flush()
        return tuple(claimed)

    def put(self, delivery: int, state: DeliveryState, outcome: str, at: datetime) -> None:
        """Writes the outcome of an attempt; ``at``: its end, or where the message still waits the time of the next
        one.
        """
        is_waiting = state is DeliveryState.WAITING
        put = update(DeliveryRow).where(DeliveryRow.id == delivery, DeliveryRow.state == DeliveryState.WAITING)
        self._session.execute(put.values(state=state, outcome=outcome, ended_at=None if is_waiting else at))
        if is_waiting:
            self._queue.put_off(str(delivery), at)
        else:
            self._queue.drop(str(delivery))

    @property
    def _queue(self) -> WorkQueue:
        return WorkQueue(self._store, WorkKind.MESSAGE)


_WORK = work_of(WorkKind.MESSAGE, DeliveryRow.id)


def _due(now: datetime, but: Collection[int]) -> tuple[ColumnElement[bool], ...]:
    """Rows that are due, but for those of some webhooks."""
    due = (DeliveryRow.state == DeliveryState.WAITING, is_due(now))
    return (*due, DeliveryRow.webhook_id.not_in(tuple(but))) if but else due


def _webhook(row: WebhookRow) -> Webhook:
    return copied(Webhook, row)
