"""Parameters through time, one row a session, sensor and parameter."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import ColumnElement, delete, func, select

from service.records.history import HistoryPoint
from service.records.session import ParameterValue, StoredSession
from service.storage.queries.accepted import IS_ACCEPTED
from service.storage.queries.base import Queries
from service.storage.queries.history_points import DECIDED, POINT, StoredPoint, point_record
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


class History(Queries):
    """Parameters through time."""

    def add(self, unit: int, record: StoredSession, values: Iterable[ParameterValue]) -> None:
        """Stores the parameters of a session under its model revision, sensor after sensor."""
        own = {"session_id": record.id, "revision": record.revision, "unit_id": unit, "at": record.started_at}
        rows = [
            {
                **own,
                "sensor": value.sensor,
                "sensor_index": value.sensor_index,
                "kind": value.kind,
                "parameter": value.parameter,
                "value": value.value,
                "u": value.u,
                **dict(zip(("axis_x", "axis_y", "axis_z"), value.axis or (None, None, None), strict=True)),
            }
            for value in values
        ]
        self.insert_many(ParameterRow, rows)

    def drop(self, record: StoredSession) -> None:
        """Takes out what a session gave under its model revision: a recording moves another calibration now."""
        own = (ParameterRow.session_id == record.id, ParameterRow.revision == record.revision)
        self._session.execute(delete(ParameterRow).where(*own))

    def points(self, unit: int, wanted: HistoryQuery) -> tuple[HistoryPoint, ...]:
        """The wanted part of a unit's history, oldest first, in one query."""
        query = (
            select(*POINT)
            .join(SessionRow, SessionRow.id == ParameterRow.session_id)
            .outerjoin(DecisionRow, DECIDED)
            .where(ParameterRow.unit_id == unit, ParameterRow.revision == _revision(wanted.revision), IS_ACCEPTED)
        )
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

    def references_of_type(self, name: str, but: str, most: int) -> tuple[ParameterValue, ...]:
        """The parameters of the newest reference sessions of a type's units, without one unit."""
        newest = (
            select(SessionRow.id, SessionRow.revision)
            .join(UnitRow, UnitRow.id == SessionRow.unit_id)
            .join(UnitTypeRow, UnitTypeRow.id == UnitRow.unit_type_id)
            .where(UnitTypeRow.name == name, UnitRow.serial != but, SessionRow.is_reference, IS_ACCEPTED)
            .order_by(SessionRow.started_at.desc(), SessionRow.id)
            .limit(most)
            .subquery()
        )
        own = (ParameterRow.session_id == newest.c.id) & (ParameterRow.revision == newest.c.revision)
        rows = self._session.scalars(select(ParameterRow).join(newest, own))
        return tuple(_parameter_value(row) for row in rows)


def _parameter_value(row: ParameterRow) -> ParameterValue:
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
