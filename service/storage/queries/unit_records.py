"""What everything that is derived of a unit rests on: its sessions in short, its breaks, what engineers chose."""

from typing import Any

from sqlalchemy import BindParameter, CompoundSelect, Select, bindparam, literal_column, null, select, union_all
from sqlalchemy.orm import Session

from service.records.derivation import Counted, UnitRecords
from service.records.state import RecordState
from service.records.work import WorkKind
from service.storage.queries.accepted import IS_BREAK
from service.storage.state_tables import ReferenceChoiceRow
from service.storage.tables import DiagnosisRow, ServiceRow, SessionRow
from service.storage.work_tables import WorkRow

UNIT: BindParameter[int] = bindparam("unit")
SESSIONS: Select[*tuple[Any, ...]] = (
    select(
        literal_column("'session'").label("what"), SessionRow.id, SessionRow.block, SessionRow.programme,
        SessionRow.started_at.label("at"), SessionRow.revision.label("number"), SessionRow.is_reference,
        SessionRow.basis, SessionRow.state, DiagnosisRow.session_id.label("diagnosed"),
        WorkRow.key.label("waiting"),
    )
    .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
    .outerjoin(WorkRow, (WorkRow.kind == WorkKind.DIAGNOSIS.value) & (WorkRow.key == SessionRow.id))
    .where(SessionRow.unit_id == UNIT)
)  # fmt: skip
NOTHING = (null(),) * 5
BREAKS: Select[*tuple[Any, ...]] = select(
    literal_column("'break'"), null(), null(), null(), ServiceRow.at, null(), *NOTHING
).where(ServiceRow.unit_id == UNIT, IS_BREAK)
CHOICES: Select[*tuple[Any, ...]] = select(
    literal_column("'choice'"), ReferenceChoiceRow.session_id, null(), null(), ReferenceChoiceRow.at,
    ReferenceChoiceRow.id, *NOTHING,
).where(ReferenceChoiceRow.unit_id == UNIT)  # fmt: skip
ALL: CompoundSelect[*tuple[Any, ...]] = union_all(SESSIONS, BREAKS, CHOICES)


def unit_records(transaction: Session, unit: int) -> UnitRecords:
    """Read in one statement."""
    rows = transaction.execute(ALL, {"unit": unit}).all()
    sessions, breaks, choices = ([row for row in rows if row.what == what] for what in ("session", "break", "choice"))
    accepted = (Counted(*row[1:8]) for row in sessions if row.state == RecordState.ACCEPTED)
    return UnitRecords(
        counted=tuple(sorted(accepted, key=lambda one: (one.at, one.id))),
        breaks=tuple(sorted({row.at for row in breaks})),
        choices=tuple(row.id for row in sorted(choices, key=lambda row: row.number)),
        references=frozenset(row.id for row in sessions if row.is_reference),
        diagnosed={row.id: row.at for row in sessions if row.diagnosed},
        waiting={row.id: row.at for row in sessions if row.waiting},
    )
