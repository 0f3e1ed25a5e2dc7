"""Units that are asked for: what narrows the list, what orders it, and from which unit on it is read.

A page of the list begins after a unit, not after a number of them: it costs the same however far one reads, and what
changes meanwhile moves nothing (keyset paging).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any, TypeVarTuple

from sqlalchemy import ColumnElement, Select, String, Subquery, and_, case, cast, false, func, literal, or_, select

from service.diagnosis.tables import DiagnosisRow
from service.fleet.records import Announced, FleetQuery, Order
from service.fleet.tables import ConditionRow
from service.groups.records import FoundTogether, Group, Level
from service.groups.tables import GroupDiagnosisRow
from service.outlook.tables import OutlookRow
from service.queue.records import WorkKind
from service.queue.tables import WorkRow
from service.sessions.decision import Verdict
from service.sessions.states import Questioned, RecordState
from service.sessions.tables import SessionRow
from service.stands.records import StandCondition
from service.stands.tables import StandConditionRow, StandRow
from service.storage.json_text import STORED
from service.storage.queries import Queries, lists
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow

Summaries = Select[
    UnitRow, str, ConditionRow, SessionRow, DiagnosisRow, datetime | None, str, str, str, Any, *tuple[Any, ...]
]

Columns = TypeVarTuple("Columns")
"""Of whatever is asked of units."""


def matching(query: Select[*Columns], wanted: FleetQuery) -> Select[*Columns]:
    """The wanted units only, in the wanted order."""
    return query.where(*_by_condition(wanted), *_by_date(wanted), *_by_place(wanted)).order_by(
        *(key.order for key in keys(wanted))
    )


def _by_condition(wanted: FleetQuery) -> list[ColumnElement[bool]]:
    said_with = DiagnosisRow.reservations
    found: list[ColumnElement[bool]] = []
    if wanted.verdict is not None:
        found.append(ConditionRow.severity == wanted.verdict.severity)
    if wanted.reserved is not None:
        found.append(said_with.is_not(None) if wanted.reserved else said_with.is_(None))
    if wanted.reference is not None:
        found.append(SessionRow.is_reference.is_(wanted.reference))
    if wanted.unfit:
        worst = Verdict.UNDECIDABLE.severity
        found.append((ConditionRow.severity > worst) | ((ConditionRow.severity == worst) & ~SessionRow.is_reference))
    if wanted.flagged:
        found.append(ConditionRow.flags > 0)
    return found


def _by_date(wanted: FleetQuery) -> list[ColumnElement[bool]]:
    found: list[ColumnElement[bool]] = [OutlookRow.due.is_(None)] if wanted.undated else []
    return found if wanted.due_before is None else [*found, OutlookRow.due < wanted.due_before]


def _by_place(wanted: FleetQuery) -> list[ColumnElement[bool]]:
    found: list[ColumnElement[bool]] = []
    if wanted.text:
        in_serial = UnitRow.serial.icontains(wanted.text, autoescape=True)
        found.append(in_serial | UnitTypeRow.name.icontains(wanted.text, autoescape=True))
    if wanted.unit_type is not None:
        found.append(UnitTypeRow.name == wanted.unit_type)
    if wanted.stand is not None:
        found.append(
            ConditionRow.stand_id == select(StandRow.id).where(StandRow.name == wanted.stand).scalar_subquery()
        )
    if wanted.lot is not None:
        found.append(UnitRow.lot == wanted.lot)
    return found


@dataclass(frozen=True)
class Key:
    """One of the columns that units are ordered by."""

    column: Any
    is_falling: bool = False
    """Whether the largest comes first."""
    nulls_first: bool | None = None
    """Where units without it come; None where every unit has it."""

    @property
    def turned(self) -> "Key":
        """The same read backwards."""
        return Key(self.column, not self.is_falling, None if self.nulls_first is None else not self.nulls_first)

    @property
    def order(self) -> ColumnElement[Any]:
        """As a query is told it."""
        order: ColumnElement[Any] = self.column.desc() if self.is_falling else self.column.asc()
        if self.nulls_first is None:
            return order
        return order.nulls_first() if self.nulls_first else order.nulls_last()

    def is_after(self, value: Any) -> ColumnElement[bool]:
        """Units that come later by this column alone."""
        if value is None:
            return self.column.is_not(None) if self.nulls_first else false()
        later: ColumnElement[bool] = self.column < value if self.is_falling else self.column > value
        return or_(later, self.column.is_(None)) if self.nulls_first is False else later

    def is_same(self, value: Any) -> ColumnElement[bool]:
        """Units that are alike by it."""
        same: ColumnElement[bool] = self.column.is_(None) if value is None else self.column == value
        return same


def keys(wanted: FleetQuery) -> tuple[Key, ...]:
    """What the rows are read by; the last is another for every unit."""
    down = wanted.backwards
    by: tuple[Key, ...] = ()
    if wanted.order is Order.CONDITION:
        by = (Key(ConditionRow.severity, not down), Key(ConditionRow.margin, down, nulls_first=down))
    elif wanted.order is Order.DUE:
        by = (Key(OutlookRow.due, down, nulls_first=not down),)
    elif wanted.order is Order.TYPE:
        by = (Key(UnitTypeRow.name, down),)
    elif wanted.order is Order.LAST:
        by = (Key(ConditionRow.last_at, down),)
    found = (*by, Key(UnitRow.serial, down and wanted.order is Order.SERIAL))
    return found if wanted.before is None else tuple(key.turned for key in found)


def beyond(wanted: FleetQuery, place: Sequence[Any]) -> ColumnElement[bool]:
    """Units that come after the one with these values, or before it."""
    found: list[ColumnElement[bool]] = []
    alike: list[ColumnElement[bool]] = []
    for key, value in zip(keys(wanted), place, strict=True):
        found.append(and_(*alike, key.is_after(value)))
        alike.append(key.is_same(value))
    return or_(*found)


WIDEST = (Level.STAND, Level.TYPE, Level.UNIT)
"""What concerns most units first."""


class Announcements(Queries):
    """Stands that shifted, sessions that wait for an engineer, what sessions show together."""

    def all(self, questioned: int, found: int) -> Announced:
        """At most so many of the second and of the third."""
        of = lists("stands", "questioned", "found")
        shifts, waiting, together = _shifts(), _questioned(questioned), _found(found)
        query = (
            select(of.c.list, shifts.c.document, waiting, together)
            .outerjoin_from(of, shifts, of.c.list == "stands")
            .outerjoin(waiting, of.c.list == "questioned")
            .outerjoin(together, of.c.list == "found")
            .order_by(shifts.c.name, waiting.c.uploaded_at.desc(), waiting.c.id, together.c.place, together.c.group_id)
        )
        rows = self._session.execute(query).mappings().all()
        own = {name: [row for row in rows if row["list"] == name] for name in ("stands", "questioned", "found")}
        groups = [row for row in own["found"] if row["level"] is not None]
        return Announced(
            stands=tuple(
                STORED.read(StandCondition, r["document"]) for r in own["stands"] if r["document"] is not None
            ),
            questioned=tuple(Questioned(r["id"], r["serial"], r["started_at"]) for r in own["questioned"] if r["id"]),
            found=tuple(
                FoundTogether(Group(Level(r["level"]), r["group_id"], r["group_name"]), r["own"]) for r in groups
            ),
            groups=groups[0]["groups"] if groups else 0,
        )


def _shifts() -> Subquery:
    query = select(StandRow.name, StandConditionRow.document).join(StandRow, StandRow.id == StandConditionRow.stand_id)
    return query.where(StandConditionRow.shifts > 0).subquery("shifts")


def _questioned(most: int) -> Subquery:
    row = SessionRow
    query = select(row.id, UnitRow.serial, row.started_at, row.uploaded_at).join(UnitRow)
    latest = query.where(row.state == RecordState.QUESTIONED).order_by(row.uploaded_at.desc(), row.id)
    return latest.limit(most).subquery("questioned")


def _found(most: int) -> Subquery:
    """Groups whose answer is being made again are left out."""
    row = GroupDiagnosisRow
    place_of = row.level + literal(" ") + cast(row.group_id, String)
    again = select(WorkRow.id).where(WorkRow.kind == WorkKind.GROUP, WorkRow.key == place_of).exists()
    place = case({level.value: place for place, level in enumerate(WIDEST)}, value=row.level).label("place")
    name = func.coalesce(UnitRow.serial, UnitTypeRow.name, StandRow.name).label("group_name")
    query = (
        select(row.level, row.group_id, name, row.own, place, func.count().over().label("groups"))
        .outerjoin(UnitRow, (row.level == Level.UNIT.value) & (UnitRow.id == row.group_id))
        .outerjoin(UnitTypeRow, (row.level == Level.TYPE.value) & (UnitTypeRow.id == row.group_id))
        .outerjoin(StandRow, (row.level == Level.STAND.value) & (StandRow.id == row.group_id))
        .where(row.own != "", ~again)
    )
    return query.order_by(place, row.group_id).limit(most).subquery("found")
