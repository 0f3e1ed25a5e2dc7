"""Remarks on units' histories, and their withdrawals."""

from datetime import datetime

from sqlalchemy import Select, select

from service.errors import NotFoundError
from service.records.event import Note, Withdrawal
from service.storage.queries.base import Queries
from service.storage.remark_tables import NoteRow, WithdrawalRow
from service.storage.tables import UnitRow


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
        found = self._session.execute(_notes().where(NoteRow.id == id)).one_or_none()
        if found is None:
            raise NotFoundError(f"There is no note {id}.")
        return note_record(*found)

    def of_unit(self, serial: str) -> tuple[Note, ...]:
        """All notes of a unit, withdrawn ones too, oldest first."""
        found = self._session.execute(_notes().where(UnitRow.serial == serial).order_by(NoteRow.at, NoteRow.id))
        return tuple(note_record(*row) for row in found)

    def of_session(self, id: str) -> tuple[Note, ...]:
        """All notes on a session, withdrawn ones too, in the order in which they were written."""
        found = self._session.execute(_notes().where(NoteRow.session_id == id).order_by(NoteRow.id))
        return tuple(note_record(*row) for row in found)


def _notes() -> Select[NoteRow, str, WithdrawalRow]:
    return (
        select(NoteRow, UnitRow.serial, WithdrawalRow)
        .join(UnitRow, UnitRow.id == NoteRow.unit_id)
        .outerjoin(WithdrawalRow, WithdrawalRow.note_id == NoteRow.id)
    )


def note_record(row: NoteRow, serial: str, withdrawn: WithdrawalRow | None) -> Note:
    """A stored note."""
    return Note(
        id=row.id,
        unit=serial,
        at=row.at,
        text=row.text,
        who=row.who,
        recorded_at=row.recorded_at,
        session=row.session_id,
        withdrawal=None if withdrawn is None else Withdrawal(withdrawn.at, withdrawn.who, withdrawn.why),
    )
