"""Conditions and orders of lists of units, and the announcements above the list on the fleet page."""

from datetime import datetime

from sqlalchemy import ColumnElement, String, Subquery, case, cast, false, func, literal, select

from service.diagnosis.tables import DiagnosisRow
from service.fleet.records import Announced, FleetQuery, Order, UseAt
from service.fleet.tables import ConditionRow, UseRow
from service.fleet.use import SLACK, Use
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
from service.storage.listing import Key, Listing
from service.storage.queries import Queries, lists
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow

BY_SERIAL = Key(UnitRow.serial, stays=True)


def forbids(now: datetime) -> ColumnElement[bool]:
    """Whether the clock forbids the use, whatever is stored: the calibration is overdue, or dated in the future."""
    return func.coalesce((OutlookRow.due < now) | (ConditionRow.last_at > now + SLACK), false())


def _has_use(wanted: UseAt) -> ColumnElement[bool]:
    if wanted.use is Use.NO:
        return (UseRow.answer == Use.NO) | forbids(wanted.at)
    return (UseRow.answer == wanted.use) & ~forbids(wanted.at)


WORST_FIRST = (
    Key(ConditionRow.severity, is_falling=True, nulls_first=False),
    Key(ConditionRow.margin, nulls_first=False),
)
ORDERS = {
    Order.USE: (Key(UseRow.rank, nulls_first=True), *WORST_FIRST),
    Order.CONDITION: WORST_FIRST,
    Order.DUE: (Key(OutlookRow.due, nulls_first=True),),
    Order.TYPE: (Key(UnitTypeRow.name),),
    Order.LAST: (Key(ConditionRow.last_at, nulls_first=True),),
}


def _is_reserved(is_so: bool) -> ColumnElement[bool]:
    said_with = DiagnosisRow.reservations
    return said_with.is_not(None) if is_so else said_with.is_(None)


def _is_unfit(_: bool) -> ColumnElement[bool]:
    worst = Verdict.UNDECIDABLE.severity
    return (ConditionRow.severity > worst) | ((ConditionRow.severity == worst) & ~SessionRow.is_reference)


def _has(text: str) -> ColumnElement[bool]:
    return UnitRow.serial.icontains(text, autoescape=True) | UnitTypeRow.name.icontains(text, autoescape=True)


def _is_on(stand: str) -> ColumnElement[bool]:
    return ConditionRow.stand_id == select(StandRow.id).where(StandRow.name == stand).scalar_subquery()


UNITS: Listing[FleetQuery] = Listing(
    name=UnitRow.serial,
    keys=lambda wanted: (*ORDERS[wanted.order], BY_SERIAL) if wanted.order in ORDERS else (Key(UnitRow.serial),),
    conditions={
        "use": _has_use,
        "verdict": lambda verdict: ConditionRow.severity == verdict.severity,
        "reserved": _is_reserved,
        "unfit": _is_unfit,
        "flagged": lambda flagged: ConditionRow.flags > 0 if flagged else ConditionRow.flags == 0,
        "undated": lambda _: OutlookRow.due.is_(None),
        "due_before": lambda due: OutlookRow.due < due,
        "due_since": lambda due: OutlookRow.due >= due,
        "text": _has,
        "unit_type": lambda name: UnitTypeRow.name == name,
        "stand": _is_on,
        "lot": lambda lot: UnitRow.lot == lot,
        "location": lambda place: UnitRow.location == place,
        "custodian": lambda name: UnitRow.custodian == name,
        "uncalibrated": lambda _: ConditionRow.unit_id.is_(None),
    },
)


WIDEST = (Level.STAND, Level.TYPE, Level.UNIT)
"""Levels of groups, that of most units first."""


class Announcements(Queries):
    """Stands that shifted, sessions that wait for an engineer, and findings of groups."""

    def all(self, questioned: int, found: int) -> Announced:
        """All announcements, with at most so many questioned sessions and findings of groups."""
        listed = lists("stands", "questioned", "found")
        shifts, waiting, together = _shifts(), _questioned(questioned), _found(found)
        query = (
            select(listed.c.list, shifts.c.document, waiting, together)
            .outerjoin_from(listed, shifts, listed.c.list == "stands")
            .outerjoin(waiting, listed.c.list == "questioned")
            .outerjoin(together, listed.c.list == "found")
            .order_by(shifts.c.name, waiting.c.uploaded_at.desc(), waiting.c.id, together.c.place, together.c.group_id)
        )
        rows = self._session.execute(query).mappings().all()
        by_list = {name: [row for row in rows if row["list"] == name] for name in ("stands", "questioned", "found")}
        groups = [row for row in by_list["found"] if row["level"] is not None]
        return Announced(
            stands=tuple(
                STORED.read(StandCondition, r["document"]) for r in by_list["stands"] if r["document"] is not None
            ),
            questioned=tuple(
                Questioned(r["id"], r["serial"], r["started_at"]) for r in by_list["questioned"] if r["id"]
            ),
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
    latest = query.where(row.state == RecordState.QUESTIONED, UnitRow.retired_at.is_(None)).order_by(
        row.uploaded_at.desc(), row.id
    )
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
        .where(row.own != "", ~again, UnitRow.retired_at.is_(None))
    )
    return query.order_by(place, row.group_id).limit(most).subquery("found")
