"""Notes and files that people attach to units and sessions, and their withdrawals."""

from datetime import datetime

from sqlalchemy import ColumnElement, Select, String, cast, select

from service.errors import NotFoundError
from service.kit.copying import copied
from service.sessions.states import RecordKind
from service.sessions.states_store import state_change
from service.sessions.tables import RecordStateRow
from service.storage.queries import Queries, lists
from service.units.records import Attachment, NewAttachment, Note, UnitEvents, Withdrawal
from service.units.store import service_record
from service.units.tables import AttachmentRow, AttachmentWithdrawalRow, NoteRow, ServiceRow, UnitRow, WithdrawalRow


class Notes(Queries):
    """Notes by unit; a row is written once."""

    def add(self, unit: int, at: datetime, text: str, who: str, now: datetime, *, session: str | None = None) -> int:
        """Stores a note and returns its number."""
        row = NoteRow(unit_id=unit, at=at, text=text, who=who, recorded_at=now, session_id=session)
        self._session.add(row)
        self._session.flush()
        return row.id

    def withdraw(self, id: int, who: str, why: str, now: datetime) -> bool:
        """Stores that a note no longer holds, and returns whether that is new; the first reason stays."""
        return self.insert_once(WithdrawalRow, note_id=id, at=now, who=who, why=why)

    def get(self, id: int) -> Note:
        """One note."""
        row = self._session.execute(_notes().where(NoteRow.id == id)).one_or_none()
        if row is None:
            raise NotFoundError("There is no note {id}.", id=id)
        return note_record(*row)

    def of_unit(self, serial: str) -> tuple[Note, ...]:
        """All notes of a unit, withdrawn ones too, oldest first."""
        rows = self._session.execute(_notes().where(UnitRow.serial == serial).order_by(NoteRow.at, NoteRow.id))
        return tuple(note_record(*row) for row in rows)

    def of_session(self, id: str) -> tuple[Note, ...]:
        """All notes on a session, withdrawn ones too, in the order in which they were written."""
        rows = self._session.execute(_notes().where(NoteRow.session_id == id).order_by(NoteRow.id))
        return tuple(note_record(*row) for row in rows)


def _notes() -> Select[NoteRow, str, WithdrawalRow]:
    return (
        select(NoteRow, UnitRow.serial, WithdrawalRow)
        .join(UnitRow, UnitRow.id == NoteRow.unit_id)
        .outerjoin(WithdrawalRow, WithdrawalRow.note_id == NoteRow.id)
    )


def note_record(row: NoteRow, serial: str, withdrawal: WithdrawalRow | None) -> Note:
    """A stored note."""
    return copied(Note, row, unit=serial, session=row.session_id, withdrawal=_withdrawal(withdrawal))


def _withdrawal(row: WithdrawalRow | AttachmentWithdrawalRow | None) -> Withdrawal | None:
    return None if row is None else copied(Withdrawal, row)


class Attachments(Queries):
    """Attachments by unit and session; a row is written once."""

    def add(self, unit: int, new: NewAttachment) -> int:
        """Stores the description of an attached file and returns its number."""
        values = dict(vars(new))
        row = AttachmentRow(unit_id=unit, session_id=values.pop("session"), **values)
        self._session.add(row)
        self._session.flush()
        return row.id

    def withdraw(self, id: int, withdrawn: Withdrawal) -> bool:
        """Stores that a file is no longer given out, and returns whether that is new; the first reason stays."""
        values = {"at": withdrawn.at, "who": withdrawn.who, "why": withdrawn.why}
        return self.insert_once(AttachmentWithdrawalRow, attachment_id=id, **values)

    def get(self, id: int) -> Attachment:
        """One attached file."""
        row = self._session.execute(_attachments().where(AttachmentRow.id == id)).one_or_none()
        if row is None:
            raise NotFoundError("There is no attachment {id}.", id=id)
        return attachment_record(*row)

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


def attachment_record(row: AttachmentRow, serial: str, withdrawal: AttachmentWithdrawalRow | None) -> Attachment:
    """A stored attachment."""
    return copied(Attachment, row, unit=serial, session=row.session_id, withdrawal=_withdrawal(withdrawal))


class SaidOf(Queries):
    """Remarks, attached files and services, withdrawn ones too."""

    def unit(self, serial: str) -> UnitEvents:
        """Notes and files of a unit as a whole, and files of its sessions; oldest first."""
        return self._said(serial, UnitRow.id == NoteRow.unit_id, UnitRow.id == AttachmentRow.unit_id)

    def session(self, unit: str, id: str) -> UnitEvents:
        """Notes and files of one session of a unit; in the order of recording."""
        return self._said(unit, NoteRow.session_id == id, AttachmentRow.session_id == id)

    def _said(self, serial: str, of_note: ColumnElement[bool], of_file: ColumnElement[bool]) -> UnitEvents:
        listed, of_unit = lists("notes", "files", "services", "changes"), ServiceRow.unit_id == UnitRow.id
        services = select(cast(ServiceRow.id, String)).where(of_unit).correlate(UnitRow)
        changed = (RecordStateRow.kind == RecordKind.SERVICE) & RecordStateRow.record.in_(services)
        query = (
            select(NoteRow, WithdrawalRow, AttachmentRow, AttachmentWithdrawalRow, ServiceRow, RecordStateRow)
            .select_from(listed)
            .join(UnitRow, UnitRow.serial == serial)
            .outerjoin(NoteRow, (listed.c.list == "notes") & of_note)
            .outerjoin(WithdrawalRow, WithdrawalRow.note_id == NoteRow.id)
            .outerjoin(AttachmentRow, (listed.c.list == "files") & of_file)
            .outerjoin(AttachmentWithdrawalRow, AttachmentWithdrawalRow.attachment_id == AttachmentRow.id)
            .outerjoin(ServiceRow, (listed.c.list == "services") & of_unit)
            .outerjoin(RecordStateRow, (listed.c.list == "changes") & changed)
            .order_by(NoteRow.at, NoteRow.id, AttachmentRow.id, ServiceRow.at, ServiceRow.id, RecordStateRow.id)
        )
        rows = self._session.execute(query).all()
        return UnitEvents(
            notes=tuple(note_record(note, serial, gone) for note, gone, *_ in rows if note is not None),
            files=tuple(attachment_record(file, serial, gone) for *_, file, gone, _, _ in rows if file is not None),
            services=tuple(service_record(service, serial) for *_, service, _ in rows if service is not None),
            changes=tuple(state_change(row) for *_, row in rows if row is not None),
        )
