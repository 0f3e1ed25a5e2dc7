"""What happened to flags and verdicts, and the outbox of those who are told."""

from datetime import datetime

from sqlalchemy import insert, literal, select

from service.records.flag import Notice, NoticeKind
from service.storage.queries.base import Queries
from service.storage.tables import DeliveryRow, NoticeRow, WebhookRow


class Notices(Queries):
    """Notices; a row is written once."""

    def add(
        self,
        unit: int,
        kind: NoticeKind,
        at: datetime,
        who: str,
        text: str,
        *,
        flag: int | None = None,
        session: str | None = None,
    ) -> None:
        """Stores a notice, and puts it into the outbox of every address that is told of its kind."""
        row = NoticeRow(unit_id=unit, flag_id=flag, kind=kind, at=at, who=who, text=text, session_id=session)
        self._session.add(row)
        self._session.flush()
        if kind is not NoticeKind.SEEN:
            self._put_into_outbox(row.id, at)

    def _put_into_outbox(self, notice: int, at: datetime) -> None:
        columns = ("notice_id", "webhook_id", "state", "attempts", "next_at", "outcome")
        told = select(
            literal(notice), WebhookRow.id, literal("waiting"), literal(0), literal(at, NoticeRow.at.type), literal("")
        ).where(WebhookRow.removed_at.is_(None))
        self._session.execute(insert(DeliveryRow).from_select(columns, told))


def notice_of(row: NoticeRow, serial: str) -> Notice:
    """The record of a row."""
    return Notice(
        id=row.id,
        unit=serial,
        flag=row.flag_id,
        kind=NoticeKind(row.kind),
        at=row.at,
        who=row.who,
        text=row.text,
        session=row.session_id,
    )
