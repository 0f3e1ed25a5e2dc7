"""Files that people attach to units and sessions, and their withdrawals."""

from sqlalchemy import Select, select

from service.errors import NotFoundError
from service.records.event import Attachment, NewAttachment, Withdrawal
from service.storage.queries.base import Queries
from service.storage.remark_tables import AttachmentRow, AttachmentWithdrawalRow
from service.storage.tables import UnitRow


class Attachments(Queries):
    """Attachments by unit and session; a row is written once."""

    def add(self, unit: int, new: NewAttachment) -> int:
        """Stores what is known of an attached file and returns its number."""
        row = AttachmentRow(unit_id=unit, session_id=new.session, sha256=new.sha256, filename=new.filename,
                            size=new.size, text=new.text, who=new.who, at=new.at)  # fmt: skip
        self._session.add(row)
        self._session.flush()
        return row.id

    def withdraw(self, id: int, withdrawn: Withdrawal) -> bool:
        """Stores that a file is no longer given out, and returns whether that is new; the first reason stays."""
        own = {"at": withdrawn.at, "who": withdrawn.who, "why": withdrawn.why}
        return self.insert_once(AttachmentWithdrawalRow, attachment_id=id, **own)

    def get(self, id: int) -> Attachment:
        """One attached file."""
        found = self._session.execute(_attachments().where(AttachmentRow.id == id)).one_or_none()
        if found is None:
            raise NotFoundError(f"There is no attachment {id}.")
        return attachment_record(*found)

    def of_unit(self, serial: str) -> tuple[Attachment, ...]:
        """All of a unit and of its sessions, withdrawn ones too, oldest first."""
        return self._found(_attachments().where(UnitRow.serial == serial))

    def of_session(self, id: str) -> tuple[Attachment, ...]:
        """All of a session, withdrawn ones too, oldest first."""
        return self._found(_attachments().where(AttachmentRow.session_id == id))

    def _found(self, query: Select[AttachmentRow, str, AttachmentWithdrawalRow]) -> tuple[Attachment, ...]:
        return tuple(attachment_record(*row) for row in self._session.execute(query.order_by(AttachmentRow.id)))


def _attachments() -> Select[AttachmentRow, str, AttachmentWithdrawalRow]:
    return (
        select(AttachmentRow, UnitRow.serial, AttachmentWithdrawalRow)
        .join(UnitRow, UnitRow.id == AttachmentRow.unit_id)
        .outerjoin(AttachmentWithdrawalRow, AttachmentWithdrawalRow.attachment_id == AttachmentRow.id)
    )


def attachment_record(row: AttachmentRow, serial: str, gone: AttachmentWithdrawalRow | None) -> Attachment:
    """A stored attachment."""
    return Attachment(
        id=row.id,
        unit=serial,
        session=row.session_id,
        sha256=row.sha256,
        filename=row.filename,
        size=row.size,
        text=row.text,
        who=row.who,
        at=row.at,
        withdrawal=None if gone is None else Withdrawal(gone.at, gone.who, gone.why),
    )
