"""Parameters through time, one row a session, sensor and parameter."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import ColumnElement, delete, func, select, true

from service.records.history import HistoryPoint
from service.records.session import ParameterValue, StoredSession
from service.storage.queries.accepted import IS_ACCEPTED
from service.storage.queries.base import Queries
from service.storage.queries.history_points import DECIDED, IS_JUDGED, POINT, StoredPoint, point_record
from service.storage.tables import CalibrationRow, DecisionRow, ParameterRow, SessionRow, UnitRow, UnitTypeRow


@dataclass(frozen=True)
class HistoryQuery:
    """Which part of a unit's history is wanted."""

    parameter: str | None = None
    sensor: str | None = None
    since: datetime | None = None
    until: datetime | None = None
    offset: int = 0
    limit: int = 10_000
    revision: int | None = None
    """As computed under this model revision or the last one before it; None for what is in force."""
    newest: bool = False
    """Whether offset and limit count from the newest point back."""
    raw: bool = False
    """Whether what the whole block did is left in."""
    noise: bool = False
    """Whether the terms of noise are wanted beside what is judged; one that is asked for by its name always is."""


class History(Queries):
    """Parameters through time."""

    def add(self, unit: int, new: Iterable[tuple[StoredSession, Iterable[ParameterValue]]]) -> None:
        """Stores the parameters of sessions under their model revisions, sensor after sensor."""
        self.insert_many(ParameterRow, [row for record, values in new for row in _rows(unit, record, values)])

    def drop(self, record: StoredSession) -> None:
        """Takes out what a session gave under its model revision: a recording moves another calibration now."""
        own = (ParameterRow.session_id == record.id, ParameterRow.revision == record.revision)
        self._session.execute(delete(ParameterRow).where(*own, IS_JUDGED))

    def points(self, unit: int, wanted: HistoryQuery) -> tuple[HistoryPoint, ...]:
        """The wanted part of a unit's history, oldest first, in one query."""
        query = (
            select(*POINT)
            .join(SessionRow, SessionRow.id == ParameterRow.session_id)
            .outerjoin(DecisionRow, DECIDED)
            .where(ParameterRow.unit_id == unit, ParameterRow.revision == _revision(wanted.revision), IS_ACCEPTED)
        )
        if wanted.parameter is None and not wanted.noise:
            query = query.where(IS_JUDGED)
        if wanted.parameter is not None:
            query = query.where(ParameterRow.parameter == wanted.parameter)
        if wanted.sensor is not None:
            query = query.where(ParameterRow.sensor == wanted.sensor)
        if wanted.since is not None:
            query = query.where(ParameterRow.at >= wanted.since)
        if wanted.until is not None:
            query = query.where(ParameterRow.at < wanted.until)
        order = (ParameterRow.at, ParameterRow.session_id, ParameterRow.sensor_index, ParameterRow.parameter)
        query = query.order_by(*(column.desc() if wanted.newest else column for column in order))
        found = [
            point_record(StoredPoint._make(row), raw=wanted.raw)
            for row in self._session.execute(query.offset(wanted.offset).limit(wanted.limit))
        ]
        return tuple(reversed(found)) if wanted.newest else tuple(found)

    def in_force(self, unit: int) -> dict[str, tuple[ParameterValue, ...]]:
        """The parameters of a unit's sessions under their revisions in force, by session."""
        names = ("sensor", "sensor_index", "kind", "parameter", "value", "u", "axis_x", "axis_y", "axis_z")
        columns = (getattr(ParameterRow, name) for name in names)
        own = (SessionRow.id == ParameterRow.session_id) & (SessionRow.revision == ParameterRow.revision)
        query = (
            select(ParameterRow.session_id, *columns)
            .join(SessionRow, own)
            .where(ParameterRow.unit_id == unit, IS_JUDGED)
        )
        found: dict[str, list[ParameterValue]] = {}
        rows: Iterable[Any] = self._session.execute(query)
        for row in rows:
            found.setdefault(row.session_id, []).append(_parameter_value(row))
        return {session: tuple(values) for session, values in found.items()}

    def references_of_type(self, name: str, but: str, most: int, *, simulated: bool) -> tuple[ParameterValue, ...]:
        """The parameters of the newest reference sessions of a type's measured or simulated units, without one unit."""
        newest = (
            select(SessionRow.id, SessionRow.revision)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .where(UnitTypeRow.name == name, UnitRow.serial != but, UnitRow.simulated.is_(simulated))
            .where(SessionRow.is_reference, IS_ACCEPTED)
            .order_by(SessionRow.started_at.desc(), SessionRow.id)
            .limit(most)
            .subquery()
        )
        own = (ParameterRow.session_id == newest.c.id) & (ParameterRow.revision == newest.c.revision)
        rows = self._session.scalars(select(ParameterRow).join(newest, own).where(IS_JUDGED))
        return tuple(_parameter_value(row) for row in rows)

    def references_by_unit(
        self, name: str, most: int, serials: Sequence[str] | None = None
    ) -> dict[str, dict[tuple[str, str], ParameterValue]]:
        """The parameters of the newest reference sessions of a type's units, or of some of them, by serial number,
        sensor and parameter."""
        wanted = (
            select(SessionRow.id, SessionRow.revision, UnitRow.serial)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .where(UnitTypeRow.name == name, SessionRow.is_reference, IS_ACCEPTED)
            .where(UnitRow.serial.in_(serials) if serials is not None else true())
            .order_by(SessionRow.started_at.desc(), SessionRow.id)
            .limit(most)
            .subquery()
        )
        own = (ParameterRow.session_id == wanted.c.id) & (ParameterRow.revision == wanted.c.revision)
        rows = self._session.execute(select(wanted.c.serial, ParameterRow).join(wanted, own).where(IS_JUDGED))
        found: dict[str, dict[tuple[str, str], ParameterValue]] = {}
        for serial, row in rows:
            found.setdefault(serial, {}).setdefault((row.sensor, row.parameter), _parameter_value(row))
        return found


def _rows(unit: int, record: StoredSession, values: Iterable[ParameterValue]) -> Iterator[dict[str, Any]]:
    own = {"session_id": record.id, "revision": record.revision, "unit_id": unit, "at": record.started_at}
    for value in values:
        x, y, z = value.axis or (None, None, None)
        seen = {name: getattr(value, name) for name in ("sensor", "sensor_index", "kind", "parameter", "value", "u")}
        yield {**own, **seen, "axis_x": x, "axis_y": y, "axis_z": z}


def _parameter_value(row: Any) -> ParameterValue:
    """Of a row of `ParameterRow`, or of its columns."""
    axis = None
    if row.axis_x is not None and row.axis_y is not None and row.axis_z is not None:
        axis = (row.axis_x, row.axis_y, row.axis_z)
    return ParameterValue(row.sensor, row.sensor_index, row.kind, row.parameter, row.value, row.u, axis)


def _revision(wanted: int | None) -> ColumnElement[int]:
    """The revision of a session that is in force, or the last one up to the wanted."""
    if wanted is None:
        return SessionRow.revision.expression
    return (
        select(func.max(CalibrationRow.revision))
        .where(CalibrationRow.session_id == ParameterRow.session_id, CalibrationRow.revision <= wanted)
        .scalar_subquery()
    )
