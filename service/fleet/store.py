"""All units at a glance: one short row a unit, rewritten when a session of it is stored."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from sqlalchemy import (
    BindParameter,
    FromClause,
    ScalarSelect,
    Select,
    bindparam,
    delete,
    func,
    literal,
    select,
    union_all,
    update,
)
from sqlalchemy.orm import InstrumentedAttribute, aliased, join, load_only

from estimator.session import PROGRAMMES
from service.diagnosis.tables import DiagnosisRow
from service.errors import NotFoundError
from service.flags.tables import FlagRow
from service.fleet.condition import FleetCondition, UnitKnown, UnitSummary
from service.fleet.records import UNCALIBRATED, FleetChoices, FleetQuery, Tally
from service.fleet.tables import ConditionRow, FleetTallyRow, UseRow
from service.fleet.wanted_store import UNITS
from service.kit.moments import local
from service.models.records import Scope
from service.outlook.store import outlook_of, overdue_count
from service.outlook.tables import OutlookRow
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.decision import Verdict
from service.sessions.doubt import Reservations
from service.sessions.records import DiagnosisState, StoredSession
from service.sessions.states import RecordState
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.store import is_waiting, reference_query, reservations_from_list, session_record, session_rows
from service.sessions.tables import DecisionRow, SessionRow
from service.stands.tables import StandRow
from service.storage.columns import RESOLVED
from service.storage.queries import Queries
from service.types.store import unit_type_of
from service.types.tables import ToleranceRow, UnitTypeRow
from service.units.records import Customer
from service.units.store import register_entry
from service.units.tables import UnitRow

Other = aliased(SessionRow)
"""A session of the unit, beside its latest one."""
EVERY = 1_000_000
"""Units of a fleet at most, where a count is of all."""
CHOICES = ("types", "stands", "lots", "locations", "custodians")
"""Fields of `FleetChoices`."""


@dataclass(frozen=True)
class Refreshed:
    """A unit's row, and its earlier verdict."""

    latest: StoredSession | None
    """Latest accepted session; None where the unit has none, and so no row."""
    before: Verdict | None
    """Earlier verdict; None where there was no row."""
    was_reference: bool
    """Whether the latest session was one that later ones are judged against, where its verdict was another."""


OPEN_OF_GROUPS = select(func.count()).where(FlagRow.scope != Scope.UNIT, FlagRow.state != RESOLVED).scalar_subquery()
"""Number of open flags of types and stands."""


_UNIT: BindParameter[int] = bindparam("unit")
_Was = aliased(SessionRow)
"""The session that was the unit's latest."""
_LATEST = (
    session_rows()
    .add_columns(
        ConditionRow.severity,
        ConditionRow.last_session,
        _Was.is_reference,
        select(func.count())
        .select_from(Other)
        .where(Other.unit_id == _UNIT, Other.state == RecordState.ACCEPTED)
        .scalar_subquery(),
    )
    .outerjoin(ConditionRow, ConditionRow.unit_id == SessionRow.unit_id)
    .outerjoin(_Was, _Was.id == ConditionRow.last_session)
    .where(SessionRow.unit_id == _UNIT, IS_ACCEPTED)
    .order_by(SessionRow.started_at.desc(), SessionRow.id.desc())
    .limit(1)
)
"""The latest accepted session of a unit, its stored condition, and its number of sessions."""


class Fleet(Queries):
    """All units at a glance."""

    def refresh(self, unit: int) -> Refreshed:
        """Rewrites a unit's row from its latest accepted session; without one it has none."""
        self.touch(unit)
        found = self._session.execute(_LATEST, {"unit": unit}).one_or_none()
        if found is None:
            self._session.execute(delete(ConditionRow).where(ConditionRow.unit_id == unit))
            return Refreshed(None, None, was_reference=False)
        *session, severity, was_last, was_reference, count = found
        last, latest = session[0], session_record(*session)
        values = {
            "sessions": count, "last_session": last.id, "severity": latest.verdict.severity, "margin": last.margin,
            "last_at": last.started_at, "stand_id": last.stand_id,
        }  # fmt: skip
        if was_last is None:
            self.insert_many(ConditionRow, ({"unit_id": unit, "flags": 0, **values},))
            return Refreshed(latest, None, was_reference=False)
        self._session.execute(update(ConditionRow).where(ConditionRow.unit_id == unit).values(**values))
        changed = severity != latest.verdict.severity
        return Refreshed(latest, list(Verdict)[severity], was_reference=changed and was_reference)

    def count_flags(self, unit: int) -> None:
        """Rewrites how many flags of a unit are open; those of its type and of stands are not counted."""
        self.touch(unit)
        conditions = (FlagRow.unit_id == unit, FlagRow.scope == Scope.UNIT, FlagRow.state != RESOLVED)
        opened = select(func.count()).where(*conditions)
        self._session.execute(
            update(ConditionRow).where(ConditionRow.unit_id == unit).values(flags=opened.scalar_subquery())
        )

    def units(self, wanted: FleetQuery) -> tuple[UnitSummary, ...]:
        """The wanted units, worst first; one more query where the list goes on from a unit."""
        listed = _listed(wanted.retired)
        page = UNITS.page(self._session, listed, wanted)
        shown = page.cut(listed).subquery()
        query = page.ordered(_summaries(join(shown, UnitRow, UnitRow.id == shown.c.id)))
        return page.forward(_summary(row) for row in self._session.execute(query))

    def dates(self, wanted: FleetQuery) -> tuple[datetime | None, ...]:
        """The due dates of all wanted units; None where a date is not known."""
        listed = _listed(wanted.retired)
        page = UNITS.page(self._session, listed, replace(wanted, limit=EVERY))
        dates = page.cut(listed.with_only_columns(OutlookRow.due, maintain_column_froms=True))
        return tuple(self._session.scalars(dates))

    def choices(self) -> FleetChoices:
        """Types, stands, lots, places and custodians that there are, in one query."""
        types = select(literal("types"), UnitTypeRow.name)
        stands = select(literal("stands"), StandRow.name)
        lots = select(literal("lots"), UnitRow.lot).where(UnitRow.lot.is_not(None)).distinct()
        held = (_held("locations", UnitRow.location), _held("custodians", UnitRow.custodian))
        rows: Sequence[Any] = self._session.execute(union_all(types, stands, lots, *held)).all()
        return FleetChoices(**{choice: tuple(sorted(n for place, n in rows if place == choice)) for choice in CHOICES})

    def unit(self, serial: str) -> UnitSummary | None:
        """One unit."""
        row = self._session.execute(_summaries().where(UnitRow.serial == serial)).one_or_none()
        return None if row is None else _summary(row)

    def by_keys(self, units: Collection[int]) -> dict[int, tuple[UnitSummary, bool]]:
        """Units by their keys, in the order of these, and whether the fleet lists them."""
        rows = self._session.execute(_summaries().where(UnitRow.id.in_(units)).order_by(UnitRow.id))
        found = {row[0].id: (_summary(row), row[0].registered_at) for row in rows}
        return {
            unit: (summary, summary.retired_at is None and (summary.last_session or entered) is not None)
            for unit, (summary, entered) in found.items()
        }

    def get(self, serial: str) -> UnitSummary:
        """One unit; NotFoundError where there is none of that serial number."""
        unit = self.unit(serial)
        if unit is None:
            raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
        return unit

    def unit_known(self, serial: str, now: datetime) -> UnitKnown | None:
        """One unit with what its page begins with, in one query."""
        in_force = (ToleranceRow.unit_type_id == UnitTypeRow.id) & (ToleranceRow.revision == UnitTypeRow.revision)
        reference = reference_query(UnitRow.id, UnitTypeRow.block, now, PROGRAMMES).scalar_subquery()
        query = _summaries().add_columns(_waiting(), reference, OutlookRow, UnitTypeRow, ToleranceRow)
        row = self._session.execute(query.join(ToleranceRow, in_force).where(UnitRow.serial == serial)).one_or_none()
        if row is None:
            return None
        self.remember_unit(serial, row[0].id)
        unit_type, outlook = unit_type_of(*row[-2:]), row[-3]
        return UnitKnown(
            summary=_summary(row[:-5]),
            unit_type=unit_type,
            waiting=row[-5] or 0,
            reference_session=row[-4],
            outlook=None if outlook is None else outlook_of(outlook, row[0].lot, unit_type.name),
            entry=register_entry(row[0], unit_type.name),
        )

    def condition(self) -> FleetCondition:
        """The number of units in each condition."""
        return _condition(self._session.execute(_tallies().add_columns(OPEN_OF_GROUPS)).all())

    def condition_at(self, now: datetime) -> FleetCondition:
        """The condition of the fleet with the number of overdue units, in one query."""
        due = overdue_count(now).scalar_subquery()
        rows = self._session.execute(_tallies().add_columns(OPEN_OF_GROUPS, due)).all()
        return replace(_condition([row[:-1] for row in rows]), overdue=rows[0][-1] if rows else 0)

    def tallies(self) -> tuple[Tally, ...]:
        """Units with an accepted session, by their verdict and by how much of their tolerance they use."""
        rows = self._session.execute(_tallies()).all()
        return tuple(_tally(row) for row in rows if row[0] != UNCALIBRATED)


def _tallies() -> Select[int, bool, bool, int, int, int, int]:
    row = FleetTallyRow
    key = (row.severity, row.is_reference, row.is_simulated, row.bar)
    counts = (func.sum(row.units), func.sum(row.flags), func.sum(row.reserved))
    is_listed = (row.severity >= 0) | (row.severity == UNCALIBRATED)
    return select(*key, *counts).where(row.units > 0, is_listed).group_by(*key).order_by(*key)


def _tally(row: Sequence[Any]) -> Tally:
    return Tally(list(Verdict)[row[0]], *row[1:])


def _condition(rows: Sequence[Sequence[Any]]) -> FleetCondition:
    """The condition from tallies, each with the open flags of types and stands at its end."""
    tallies = [_tally(row[:-1]) for row in rows if row[0] != UNCALIBRATED]
    uncalibrated = sum(row[4] for row in rows if row[0] == UNCALIBRATED)
    return FleetCondition.of(tallies, rows[0][-1] if rows else 0, uncalibrated)


def _held(name: str, column: InstrumentedAttribute[str]) -> Select[str, str]:
    return select(literal(name), column).where(column != "", UnitRow.retired_at.is_(None)).distinct()


LAST = (
    SessionRow.started_at,
    SessionRow.utc_offset,
    SessionRow.verdict,
    SessionRow.is_reference,
    SessionRow.reason,
    SessionRow.worst_sensor,
    SessionRow.worst_parameter,
    SessionRow.margin,
)
FOUND = (DiagnosisRow.state, DiagnosisRow.summary, DiagnosisRow.gain_in_words, DiagnosisRow.reservations)
"""Columns of the diagnosis in a line of the fleet; the rest is long, and stays unread."""


_Outlook, _Derivation = aliased(WorkRow), aliased(WorkRow)
"""Pending work on a unit."""
Summaries = Select[
    UnitRow, str, ConditionRow, SessionRow, DiagnosisRow, datetime | None, str, str, str, Any, *tuple[Any, ...]
]


_WORST = (
    (DecisionRow.session_id == SessionRow.id)
    & (DecisionRow.revision == SessionRow.revision)
    & (DecisionRow.sensor == SessionRow.worst_sensor)
    & (DecisionRow.parameter == SessionRow.worst_parameter)
)
"""Condition for the decision on the parameter that sets a verdict."""


def _listed(retired: bool | None) -> Select[int]:
    """Keys of the units that a list may hold: those with an accepted session, and those in the register; retired or
    not. Beside them, what a list is narrowed or ordered by, in outer joins: a database leaves out those not used."""
    listed = (
        select(UnitRow.id)
        .outerjoin(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        .outerjoin(ConditionRow, ConditionRow.unit_id == UnitRow.id)
        .outerjoin(SessionRow, SessionRow.id == ConditionRow.last_session)
        .outerjoin(DiagnosisRow, DiagnosisRow.session_id == ConditionRow.last_session)
        .outerjoin(OutlookRow, OutlookRow.unit_id == UnitRow.id)
        .outerjoin(UseRow, UseRow.unit_id == UnitRow.id)
        .where(ConditionRow.unit_id.is_not(None) | UnitRow.registered_at.is_not(None))
    )
    return listed if retired is None else listed.where(UnitRow.retired_at.is_not(None) == retired)


def _summaries(units: FromClause = UnitRow.__table__) -> Summaries:
    """Units with their latest accepted session, if any. PostgreSQL joins so many tables in the order they are written
    in, so that ``units``, those to read, comes first."""
    return (
        select(
            UnitRow,
            UnitTypeRow.name,
            ConditionRow,
            SessionRow,
            DiagnosisRow,
            OutlookRow.due,
            _Outlook.ticket,
            func.coalesce(_Outlook.failed, _Derivation.failed),
            OutlookRow.reason,
            func.abs(DecisionRow.deviation) / DecisionRow.tolerance,
        )
        .options(load_only(*LAST, raiseload=True), load_only(*FOUND, raiseload=True))
        .select_from(units)
        .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
        .outerjoin(ConditionRow, ConditionRow.unit_id == UnitRow.id)
        .outerjoin(SessionRow, SessionRow.id == ConditionRow.last_session)
        .outerjoin(DiagnosisRow, DiagnosisRow.session_id == SessionRow.id)
        .outerjoin(DecisionRow, _WORST)
        .outerjoin(OutlookRow, OutlookRow.unit_id == UnitRow.id)
        .outerjoin(UseRow, UseRow.unit_id == UnitRow.id)
        .outerjoin(_Outlook, (_Outlook.kind == WorkKind.OUTLOOK) & (_Outlook.key == UnitRow.serial))
        .outerjoin(_Derivation, (_Derivation.kind == WorkKind.DERIVATION) & (_Derivation.key == UnitRow.serial))
    )


def _waiting() -> ScalarSelect[int]:
    """The number of accepted sessions of a unit that are to be judged or weighed."""
    conditions = (Other.unit_id == UnitRow.id, is_waiting(Other.basis), Other.state == RecordState.ACCEPTED)
    return select(func.count()).select_from(Other).where(*conditions).scalar_subquery()


def _summary(row: Sequence[Any]) -> UnitSummary:
    unit, type_name, condition, last = row[0], row[1], row[2], row[3]
    if condition is None:
        return _unmeasured(unit, type_name)
    return UnitSummary(
        serial=unit.serial,
        unit_type=type_name,
        simulated=unit.simulated,
        sessions=condition.sessions,
        last_session=last.id,
        last_at=local(last.started_at, last.utc_offset),
        verdict=Verdict(last.verdict),
        is_reference=last.is_reference,
        reason=last.reason,
        worst_sensor=last.worst_sensor,
        worst_parameter=last.worst_parameter,
        margin=last.margin,
        diagnosis=_diagnosis(row[4]),
        gain="" if row[4] is None else row[4].gain_in_words or "",
        flags=condition.flags,
        due=row[5],
        lot=unit.lot,
        reservations=_reservations(row[4]),
        customer=Customer(unit.customer, unit.customer_address),
        is_undated=row[6] is not None,
        failed=row[7] or "",
        due_reason=row[8] or "",
        deviation=row[9],
        **_held_by(unit),
    )


def _unmeasured(unit: UnitRow, type_name: str) -> UnitSummary:
    """A unit of which no session is accepted."""
    return UnitSummary(
        serial=unit.serial,
        unit_type=type_name,
        simulated=unit.simulated,
        sessions=0,
        last_session=None,
        last_at=None,
        verdict=None,
        is_reference=False,
        reason="No session of this unit is accepted: nothing is known about it.",
        worst_sensor=None,
        worst_parameter=None,
        margin=None,
        lot=unit.lot,
        customer=Customer(unit.customer, unit.customer_address),
        **_held_by(unit),
    )


def _held_by(unit: UnitRow) -> dict[str, Any]:
    return {name: getattr(unit, name) for name in ("owner", "location", "custodian", "retired_at")}


def _reservations(row: DiagnosisRow | None) -> Reservations:
    """Reservations of the verdict; None while causes are still being looked for."""
    return None if row is None else reservations_from_list(row.session_id, row.reservations)


def _diagnosis(row: DiagnosisRow | None) -> str:
    """The diagnosis in one line, where something is wrong; empty otherwise."""
    return "" if row is None or not DiagnosisState(row.state).is_wrong else row.summary
