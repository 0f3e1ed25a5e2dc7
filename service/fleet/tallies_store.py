"""Counts of the fleet, kept by differences: what every touched unit adds now, less what it added before.

A transaction notes the units that it touches; the counts are updated once, just before it commits, in the order of
their keys, so that two transactions never wait for each other crosswise.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from datetime import datetime
from typing import Any

from sqlalchemy import BindParameter, CompoundSelect, bindparam, delete, func, literal_column, select, union_all
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from service.diagnosis.tables import DiagnosisRow
from service.fleet.records import NOT_KNOWN, RETIRED, UNCALIBRATED, bar_of
from service.fleet.tables import ConditionRow, FleetTallyRow, TalliedRow
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import SessionRow
from service.stands.tables import StandTallyRow, StandUnitRow
from service.storage.queries import Queries
from service.storage.tables import Base
from service.units.tables import UnitRow

KEY = ("unit_type_id", "severity", "is_reference", "is_simulated", "bar")
"""Columns by which units are counted."""
Key = tuple[Any, ...]
Stood = tuple[int, int]
"""A unit and a stand."""


class Tallies(Queries):
    """Counts of units by condition, and of sessions by stand."""

    def settle(self, units: Collection[int]) -> None:
        """Brings the counts in line with touched units."""
        self._settle_conditions(units)
        self._settle_stands(units)

    def _settle_conditions(self, units: Collection[int]) -> None:
        was, now = self._tallied_and_seen(units)
        changed = {unit for unit, tally in now.items() if was.get(unit) != tally}
        if not changed:
            return
        rows = [{"unit_id": unit, **now[unit]} for unit in sorted(changed)]
        _put(self._session, TalliedRow, ("unit_id",), rows)
        gone = [was[unit] for unit in changed if unit in was]
        counts = _counted([now[unit] for unit in changed], gone)
        _add(self._session, FleetTallyRow, KEY, counts)

    def _tallied_and_seen(self, units: Collection[int]) -> tuple[dict[int, dict[str, Any]], dict[int, dict[str, Any]]]:
        """The earlier contributions of units, and those by their present rows."""
        rows = self._session.execute(_TALLIED_AND_SEEN, {"units": sorted(units)}).all()
        was = {row[0]: dict(zip((*KEY, "flags", "reserved"), row[10:], strict=True)) for row in rows}
        now = {
            unit: {
                "unit_type_id": of_type, "severity": _severity(severity, entered, gone),
                "is_reference": bool(reference), "is_simulated": simulated, "bar": bar_of(margin),
                "flags": flags or 0, "reserved": int(bool(reserved)),
            }
            for unit, of_type, severity, reference, simulated, margin, flags, reserved, entered, gone, *_ in rows
        }  # fmt: skip
        return {unit: tally for unit, tally in was.items() if tally["severity"] is not None}, now

    def _settle_stands(self, units: Collection[int]) -> None:
        was, now = self._stood_and_stands(units)
        changed = sorted(key for key in {*was, *now} if was.get(key) != now.get(key))
        for unit, stand in (key for key in changed if key not in now):
            place = (StandUnitRow.unit_id == unit, StandUnitRow.stand_id == stand)
            self._session.execute(delete(StandUnitRow).where(*place))
        kept = [{"unit_id": key[0], "stand_id": key[1], "sessions": now[key]} for key in changed if key in now]
        _put(self._session, StandUnitRow, ("unit_id", "stand_id"), kept)
        counts: dict[Key, Counter[str]] = {}
        for key in changed:
            more = {"sessions": now.get(key, 0) - was.get(key, 0), "units": (key in now) - (key in was)}
            counts.setdefault((key[1],), Counter()).update(more)
        _add(self._session, StandTallyRow, ("stand_id",), counts)

    def _stood_and_stands(self, units: Collection[int]) -> tuple[dict[Stood, int], dict[Stood, int]]:
        """Sessions by unit and stand as they were counted so far, and by the rows of now."""
        rows = self._session.execute(_STOOD_AND_STANDS, {"units": sorted(units)}).all()
        was, now = ({(unit, stand): count for t, unit, stand, count in rows if t == time} for time in ("was", "now"))
        return was, now


_UNITS: BindParameter[list[int]] = bindparam("units", expanding=True)
_TALLIED_AND_SEEN = (
    select(
        UnitRow.id, UnitRow.unit_type_id, ConditionRow.severity, SessionRow.is_reference, UnitRow.simulated,
        ConditionRow.margin, ConditionRow.flags, DiagnosisRow.reservations.is_not(None),
        UnitRow.registered_at, UnitRow.retired_at,
        *(getattr(TalliedRow, name) for name in (*KEY, "flags", "reserved")),
    )
    .outerjoin(ConditionRow, ConditionRow.unit_id == UnitRow.id)
    .outerjoin(SessionRow, SessionRow.id == ConditionRow.last_session)
    .outerjoin(DiagnosisRow, DiagnosisRow.session_id == ConditionRow.last_session)
    .outerjoin(TalliedRow, TalliedRow.unit_id == UnitRow.id)
    .where(UnitRow.id.in_(_UNITS))
)  # fmt: skip
_STOOD_AND_STANDS: CompoundSelect[*tuple[Any, ...]] = union_all(
    select(literal_column("'was'"), StandUnitRow.unit_id, StandUnitRow.stand_id, StandUnitRow.sessions).where(
        StandUnitRow.unit_id.in_(_UNITS)
    ),
    select(literal_column("'now'"), SessionRow.unit_id, SessionRow.stand_id, func.count())
    .where(SessionRow.unit_id.in_(_UNITS), IS_ACCEPTED, SessionRow.stand_id.is_not(None))
    .group_by(SessionRow.unit_id, SessionRow.stand_id),
)


def _severity(severity: int | None, registered_at: datetime | None, retired_at: datetime | None) -> int:
    if retired_at is not None:
        return RETIRED
    if severity is None:
        return NOT_KNOWN if registered_at is None else UNCALIBRATED
    return severity


def _counted(come: Iterable[Mapping[str, Any]], gone: Iterable[Mapping[str, Any]]) -> dict[Key, dict[str, int]]:
    counts: dict[Key, Counter[str]] = {}
    for sign, rows in ((1, come), (-1, gone)):
        for row in rows:
            counter = counts.setdefault(tuple(row[name] for name in KEY), Counter())
            for name, count in (("units", 1), ("flags", row["flags"]), ("reserved", row["reserved"])):
                counter[name] += sign * count
    return {key: {name: counter[name] for name in ("units", "flags", "reserved")} for key, counter in counts.items()}


def _add(session: Session, table: type[Base], key: tuple[str, ...], counts: Mapping[Key, Mapping[str, int]]) -> None:
    rows = list(_rows(key, counts))
    if not rows:
        return
    insertion = postgresql.insert if session.get_bind().dialect.name == "postgresql" else sqlite.insert
    new = insertion(table).values(rows)
    names = [name for name in rows[0] if name not in key]
    added = {name: getattr(table, name) + getattr(new.excluded, name) for name in names}
    session.execute(new.on_conflict_do_update(index_elements=list(key), set_=added))


def _put(session: Session, table: type[Base], key: tuple[str, ...], rows: Sequence[Mapping[str, Any]]) -> None:
    if not rows:
        return
    insertion = postgresql.insert if session.get_bind().dialect.name == "postgresql" else sqlite.insert
    new = insertion(table)
    kept = {name: getattr(new.excluded, name) for name in rows[0] if name not in key}
    session.execute(new.on_conflict_do_update(index_elements=list(key), set_=kept), list(rows))


def _rows(key: tuple[str, ...], counts: Mapping[Key, Mapping[str, int]]) -> Iterator[dict[str, Any]]:
    for place in sorted(counts):
        if any(counts[place].values()):
            yield dict(zip(key, place, strict=True)) | dict(counts[place])
