"""Counts of the fleet, kept by differences: what every touched unit adds now, less what it added before.

A transaction notes the units that it touches; the counts are brought in line once, just before it commits, in the
order of their keys, so that two transactions never wait for each other crosswise.
"""

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import Any

from sqlalchemy import delete, func, insert, select
from sqlalchemy.dialects import postgresql, sqlite
from sqlalchemy.orm import Session

from service.records.fleet import NOT_KNOWN, bar_of
from service.storage.fleet_tables import FleetTallyRow, StandTallyRow, StandUnitRow, TalliedRow
from service.storage.queries.accepted import IS_ACCEPTED
from service.storage.queries.base import TOUCHED, Queries
from service.storage.tables import Base, ConditionRow, DiagnosisRow, SessionRow, UnitRow

KEY = ("unit_type_id", "severity", "is_reference", "is_simulated", "bar")
"""What units are counted by."""
Key = tuple[Any, ...]
Stood = tuple[int, int]
"""A unit and a stand."""


class Tallies(Queries):
    """How many units are in which condition, and how many sessions were measured where."""

    def settle(self) -> None:
        """Brings the counts in line with the touched units."""
        units: set[int] = self._session.info.pop(TOUCHED, set())
        if units:
            self._session.flush()
            self._settle_conditions(units)
            self._settle_stands(units)

    def _settle_conditions(self, units: Collection[int]) -> None:
        was, now = self._tallied(units), self._seen(units)
        changed = {unit for unit, own in now.items() if was.get(unit) != own}
        if not changed:
            return
        self._session.execute(delete(TalliedRow).where(TalliedRow.unit_id.in_(changed)))
        self._session.execute(insert(TalliedRow), [{"unit_id": unit, **now[unit]} for unit in sorted(changed)])
        gone = [was[unit] for unit in changed if unit in was]
        counts = _counted([now[unit] for unit in changed], gone)
        _add(self._session, FleetTallyRow, KEY, counts)

    def _tallied(self, units: Collection[int]) -> dict[int, dict[str, Any]]:
        """What units added so far."""
        columns = [getattr(TalliedRow, name) for name in (*KEY, "flags", "reserved")]
        rows = self._session.execute(select(TalliedRow.unit_id, *columns).where(TalliedRow.unit_id.in_(units)))
        return {row[0]: dict(zip((*KEY, "flags", "reserved"), row[1:], strict=True)) for row in rows}

    def _seen(self, units: Collection[int]) -> dict[int, dict[str, Any]]:
        """What they add by their rows of now."""
        query = (
            select(
                UnitRow.id, UnitRow.unit_type_id, UnitRow.simulated, ConditionRow.severity, SessionRow.is_reference,
                ConditionRow.margin, ConditionRow.flags, DiagnosisRow.reservations.is_not(None),
            )
            .outerjoin(ConditionRow, ConditionRow.unit_id == UnitRow.id)
            .outerjoin(SessionRow, SessionRow.id == ConditionRow.last_session)
            .outerjoin(DiagnosisRow, DiagnosisRow.session_id == ConditionRow.last_session)
            .where(UnitRow.id.in_(units))
        )  # fmt: skip
        return {
            unit: {
                "unit_type_id": of_type, "is_simulated": simulated, "bar": bar_of(margin), "flags": flags or 0,
                "severity": NOT_KNOWN if severity is None else severity, "is_reference": bool(reference),
                "reserved": int(bool(reserved)),
            }
            for unit, of_type, simulated, severity, reference, margin, flags, reserved in self._session.execute(query)
        }  # fmt: skip

    def _settle_stands(self, units: Collection[int]) -> None:
        was, now = self._stood(units), self._stands(units)
        changed = sorted(key for key in {*was, *now} if was.get(key) != now.get(key))
        for unit, stand in changed:
            own = (StandUnitRow.unit_id == unit, StandUnitRow.stand_id == stand)
            self._session.execute(delete(StandUnitRow).where(*own))
        kept = [{"unit_id": key[0], "stand_id": key[1], "sessions": now[key]} for key in changed if key in now]
        if kept:
            self._session.execute(insert(StandUnitRow), kept)
        counts: dict[Key, Counter[str]] = {}
        for key in changed:
            more = {"sessions": now.get(key, 0) - was.get(key, 0), "units": (key in now) - (key in was)}
            counts.setdefault((key[1],), Counter()).update(more)
        _add(self._session, StandTallyRow, ("stand_id",), counts)

    def _stood(self, units: Collection[int]) -> dict[Stood, int]:
        """Sessions by unit and stand as they were counted so far."""
        row = StandUnitRow
        query = select(row.unit_id, row.stand_id, row.sessions).where(row.unit_id.in_(units))
        return {(unit, stand): count for unit, stand, count in self._session.execute(query)}

    def _stands(self, units: Collection[int]) -> dict[Stood, int]:
        """The same by the rows of now."""
        place = (SessionRow.unit_id, SessionRow.stand_id)
        query = select(*place, func.count()).where(SessionRow.unit_id.in_(units), IS_ACCEPTED).group_by(*place)
        return {(unit, stand): count for unit, stand, count in self._session.execute(query) if stand is not None}


def _counted(come: Iterable[Mapping[str, Any]], gone: Iterable[Mapping[str, Any]]) -> dict[Key, dict[str, int]]:
    """Differences by key."""
    counts: dict[Key, Counter[str]] = {}
    for sign, rows in ((1, come), (-1, gone)):
        for row in rows:
            own = counts.setdefault(tuple(row[name] for name in KEY), Counter())
            for name, count in (("units", 1), ("flags", row["flags"]), ("reserved", row["reserved"])):
                own[name] += sign * count
    return {key: {name: own[name] for name in ("units", "flags", "reserved")} for key, own in counts.items()}


def _add(session: Session, table: type[Base], key: tuple[str, ...], counts: Mapping[Key, Mapping[str, int]]) -> None:
    """Adds differences to counts, in the order of their keys."""
    rows = list(_rows(key, counts))
    if not rows:
        return
    own = postgresql.insert if session.get_bind().dialect.name == "postgresql" else sqlite.insert
    new = own(table).values(rows)
    names = [name for name in rows[0] if name not in key]
    added = {name: getattr(table, name) + getattr(new.excluded, name) for name in names}
    session.execute(new.on_conflict_do_update(index_elements=list(key), set_=added))


def _rows(key: tuple[str, ...], counts: Mapping[Key, Mapping[str, int]]) -> Iterator[dict[str, Any]]:
    for place in sorted(counts):
        if any(counts[place].values()):
            yield dict(zip(key, place, strict=True)) | dict(counts[place])
