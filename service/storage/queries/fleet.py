"""All units at a glance: one short row a unit, rewritten when a session of it is stored."""

from dataclasses import dataclass

from sqlalchemy import Row, Select, func, select
from sqlalchemy.orm import defer

from service.records import DiagnosisState, FleetCondition, UnitSummary, Verdict
from service.storage.queries.base import Queries
from service.storage.tables import ConditionRow, DiagnosisRow, SessionRow, UnitRow, UnitTypeRow

Summaries = Select[UnitRow, str, ConditionRow, SessionRow, DiagnosisRow]


@dataclass(frozen=True)
class FleetQuery:
    """Which units are wanted."""

    verdict: Verdict | None = None
    text: str | None = None
    """Part of the serial number or of the type's name, small and capital letters alike."""
    offset: int = 0
    limit: int = 100


class Fleet(Queries):
    """All units at a glance."""

    def refresh(self, unit: int) -> None:
        """Rewrites a unit's row from its latest session."""
        own = SessionRow.unit_id == unit
        count = self._session.scalar(select(func.count()).select_from(SessionRow).where(own))
        last = self._session.scalars(
            select(SessionRow)
            .where(own)
            .order_by(SessionRow.started_at.desc(), SessionRow.uploaded_at.desc(), SessionRow.id)
            .limit(1)
        ).one()
        self._session.merge(
            ConditionRow(
                unit_id=unit,
                sessions=count or 0,
                last_session=last.id,
                severity=Verdict(last.verdict).severity,
                margin=last.margin,
            )
        )
        self._session.flush()

    def units(self, wanted: FleetQuery) -> tuple[UnitSummary, ...]:
        """The wanted units, worst first, in one query."""
        query = _matching(_summaries(), wanted).order_by(
            ConditionRow.severity.desc(), ConditionRow.margin.asc().nulls_last(), UnitRow.serial
        )
        return tuple(_summary(row) for row in self._session.execute(query.offset(wanted.offset).limit(wanted.limit)))

    def unit(self, serial: str) -> UnitSummary | None:
        """One unit."""
        row = self._session.execute(_summaries().where(UnitRow.serial == serial)).one_or_none()
        return None if row is None else _summary(row)

    def condition(self) -> FleetCondition:
        """How many units are in which condition."""
        rows = self._session.execute(
            select(ConditionRow.severity, UnitRow.simulated, func.count())
            .join(UnitRow, UnitRow.id == ConditionRow.unit_id)
            .group_by(ConditionRow.severity, UnitRow.simulated)
        ).all()
        verdicts = {
            verdict: sum(count for severity, _, count in rows if severity == verdict.severity) for verdict in Verdict
        }
        simulated = sum(count for _, is_simulated, count in rows if is_simulated)
        return FleetCondition(units=sum(verdicts.values()), verdicts=verdicts, simulated=simulated)


def _summaries() -> Summaries:
    return (
        select(UnitRow, UnitTypeRow.name, ConditionRow, SessionRow, DiagnosisRow)
        .options(defer(DiagnosisRow.document))
        .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        .join(ConditionRow, ConditionRow.unit_id == UnitRow.id)
        .join(SessionRow, SessionRow.id == ConditionRow.last_session)
        .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
    )


def _matching(query: Summaries, wanted: FleetQuery) -> Summaries:
    if wanted.verdict is not None:
        query = query.where(ConditionRow.severity == wanted.verdict.severity)
    if wanted.text:
        query = query.where(
            UnitRow.serial.icontains(wanted.text, autoescape=True)
            | UnitTypeRow.name.icontains(wanted.text, autoescape=True)
        )
    return query


def _summary(row: Row[UnitRow, str, ConditionRow, SessionRow, DiagnosisRow]) -> UnitSummary:
    unit, type_name, condition, last = row[0], row[1], row[2], row[3]
    return UnitSummary(
        serial=unit.serial,
        unit_type=type_name,
        simulated=unit.simulated,
        sessions=condition.sessions,
        last_session=last.id,
        last_at=last.started_at,
        verdict=Verdict(last.verdict),
        is_reference=last.is_reference,
        reason=last.reason,
        worst_sensor=last.worst_sensor,
        worst_parameter=last.worst_parameter,
        margin=last.margin,
        diagnosis=_diagnosis(row[4]),
    )


def _diagnosis(row: DiagnosisRow | None) -> str:
    """In one line, where something is wrong."""
    return "" if row is None or not DiagnosisState(row.state).is_wrong else row.summary
