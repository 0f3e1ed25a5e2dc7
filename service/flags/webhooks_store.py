"""Addresses that are told of notices, and the outbox of what is on its way to them."""

from collections.abc import Collection
from dataclasses import replace
from datetime import datetime

from sqlalchemy import ColumnElement, select, update

from service.errors import NotFoundError
from service.flags.records import Delivery, DeliveryState, Matter, Outgoing, Webhook
from service.flags.store import notice_of
from service.flags.tables import DeliveryRow, FlagRow, NoticeRow, WebhookRow
from service.storage.queries import Queries
from service.units.tables import UnitRow

REMOVED = "the webhook was removed"
"""The outcome of deliveries that then still waited."""


class Webhooks(Queries):
    """Webhooks and their deliveries."""

    def add(self, url: str, secret: str, who: str, now: datetime) -> Webhook:
        """Stores an address; it is told of what happens from now on."""
        row = WebhookRow(url=url, secret=secret, who=who, created_at=now, removed_at=None)
        self._session.add(row)
        self._session.flush()
        return _webhook(row)

    def get(self, id: int) -> Webhook:
        """One address that was not removed."""
        row = self._session.scalar(select(WebhookRow).where(WebhookRow.id == id, WebhookRow.removed_at.is_(None)))
        if row is None:
            raise NotFoundError(f"There is no webhook {id}.")
        return _webhook(row)

    def every(self) -> tuple[Webhook, ...]:
        """All addresses that were not removed."""
        query = select(WebhookRow).where(WebhookRow.removed_at.is_(None)).order_by(WebhookRow.id)
        return tuple(map(_webhook, self._session.scalars(query)))

    def remove(self, id: int, now: datetime) -> None:
        """Tells an address no more; what was on its way is given up."""
        self._session.execute(update(WebhookRow).where(WebhookRow.id == id).values(removed_at=now))
        self._session.execute(
            update(DeliveryRow)
            .where(DeliveryRow.webhook_id == id, DeliveryRow.state == DeliveryState.WAITING)
            .values(state=DeliveryState.FAILED, outcome=REMOVED)
        )

    def deliveries(self, id: int, limit: int) -> tuple[Delivery, ...]:
        """The latest deliveries to an address, newest first."""
        query = (
            select(DeliveryRow, NoticeRow, UnitRow.serial)
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
                next_at=row.next_at,
                outcome=row.outcome,
            )
            for row, notice, serial in self._session.execute(query.limit(limit))
        )

    def is_due(self, now: datetime, but: Collection[int] = ()) -> bool:
        """Whether anything in the outbox is due, but for some webhooks; asked without keeping writers waiting."""
        return self._session.scalar(select(DeliveryRow.id).where(*_due(now, but)).limit(1)) is not None

    def claim(self, now: datetime, until: datetime, limit: int, but: Collection[int] = ()) -> tuple[Outgoing, ...]:
        """What is due, oldest first, but for some webhooks; claimed until a time: nobody else sends it before, and then
        somebody does."""
        query = (
            select(DeliveryRow, WebhookRow, NoticeRow, UnitRow.serial, FlagRow)
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
            row.attempts += 1
            row.next_at = until
            found = Outgoing(row.id, row.attempts, _webhook(webhook), notice_of(notice, serial), None, "")
            claimed.append(found if flag is None else replace(found, matter=Matter(flag.matter), place=flag.place))
        self._session.flush()
        return tuple(claimed)

    def put(self, delivery: int, state: DeliveryState, outcome: str, next_at: datetime) -> None:
        """Writes what became of an attempt."""
        self._session.execute(
            update(DeliveryRow)
            .where(DeliveryRow.id == delivery, DeliveryRow.state == DeliveryState.WAITING)
            .values(state=state, outcome=outcome, next_at=next_at)
        )


def _due(now: datetime, but: Collection[int]) -> tuple[ColumnElement[bool], ...]:
    """Rows that are due, but for those of some webhooks."""
    own = (DeliveryRow.state == DeliveryState.WAITING, DeliveryRow.next_at <= now)
    return (*own, DeliveryRow.webhook_id.not_in(tuple(but))) if but else own


def _webhook(row: WebhookRow) -> Webhook:
    return Webhook(id=row.id, url=row.url, secret=row.secret, who=row.who, created_at=row.created_at)
