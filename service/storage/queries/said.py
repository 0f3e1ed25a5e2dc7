"""What people said of a unit or a session, and what was done to it: short lists in one statement."""

from sqlalchemy import ColumnElement, String, cast, select

from service.records.said import Said
from service.records.state import RecordKind
from service.storage.queries.attachments import attachment_record
from service.storage.queries.base import Queries, lists
from service.storage.queries.notes import note_record
from service.storage.queries.services import service_record
from service.storage.queries.states import state_change
from service.storage.remark_tables import AttachmentRow, AttachmentWithdrawalRow, NoteRow, WithdrawalRow
from service.storage.state_tables import RecordStateRow
from service.storage.tables import ServiceRow, UnitRow


class SaidOf(Queries):
    """Remarks, attached files and services, withdrawn ones too."""

    def unit(self, serial: str) -> Said:
        """Of a unit as a whole, and files of its sessions; oldest first."""
        return self._said(serial, UnitRow.id == NoteRow.unit_id, UnitRow.id == AttachmentRow.unit_id)

    def session(self, unit: str, id: str) -> Said:
        """Of one session of a unit; in the order in which it was said."""
        return self._said(unit, NoteRow.session_id == id, AttachmentRow.session_id == id)

    def _said(self, serial: str, of_note: ColumnElement[bool], of_file: ColumnElement[bool]) -> Said:
        of, own = lists("notes", "files", "services", "changes"), ServiceRow.unit_id == UnitRow.id
        services = select(cast(ServiceRow.id, String)).where(own).correlate(UnitRow)
        changed = (RecordStateRow.kind == RecordKind.SERVICE) & RecordStateRow.record.in_(services)
        query = (
            select(NoteRow, WithdrawalRow, AttachmentRow, AttachmentWithdrawalRow, ServiceRow, RecordStateRow)
            .select_from(of)
            .join(UnitRow, UnitRow.serial == serial)
            .outerjoin(NoteRow, (of.c.list == "notes") & of_note)
            .outerjoin(WithdrawalRow, WithdrawalRow.note_id == NoteRow.id)
            .outerjoin(AttachmentRow, (of.c.list == "files") & of_file)
            .outerjoin(AttachmentWithdrawalRow, AttachmentWithdrawalRow.attachment_id == AttachmentRow.id)
            .outerjoin(ServiceRow, (of.c.list == "services") & own)
            .outerjoin(RecordStateRow, (of.c.list == "changes") & changed)
            .order_by(NoteRow.at, NoteRow.id, AttachmentRow.id, ServiceRow.at, ServiceRow.id, RecordStateRow.id)
        )
        rows = self._session.execute(query).all()
        return Said(
            notes=tuple(note_record(note, serial, gone) for note, gone, *_ in rows if note is not None),
            files=tuple(attachment_record(file, serial, gone) for *_, file, gone, _, _ in rows if file is not None),
            services=tuple(service_record(service, serial) for *_, service, _ in rows if service is not None),
            changes=tuple(state_change(row) for *_, row in rows if row is not None),
        )
