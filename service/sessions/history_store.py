"""Parameters through time, one row a session, sensor and parameter, with the decision on it.

Histories have thousands of points: their columns are read, not whole rows as objects, and of a decision only the
columns of a point.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import datetime
from math import hypot
from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, and_, delete, func, select, true
from sqlalchemy.orm import aliased

from estimator.allan.results import TERMS, interval_of
from service.sessions.decision import Verdict
from service.sessions.records import HistoryPoint, ParameterValue, StoredSession
from service.sessions.states import RecordState
from service.sessions.states_store import IS_ACCEPTED
from service.sessions.tables import CalibrationRow, DecisionRow, ParameterRow, SessionRow
from service.storage.queries import Queries
from service.types.tables import UnitTypeRow
from service.units.tables import UnitRow

DECIDED = (
    (DecisionRow.session_id == ParameterRow.session_id)
    & (DecisionRow.revision == ParameterRow.revision)
    & (DecisionRow.sensor == ParameterRow.sensor)
    & (DecisionRow.parameter == ParameterRow.parameter)
)
"""The decision on a parameter, under the same model revision."""
IS_JUDGED = ParameterRow.parameter.not_in(TERMS)
"""Condition of the parameters of a calibration: the terms of noise are in the same table and are never judged."""


class StoredPoint(NamedTuple):
    """Columns of a query of points, in the order of `POINT`; those of the decision are None where there is none."""

    session: str
    at: datetime
    sensor: str
    kind: str
    parameter: str
    value: float | None
    u: float | None
    axis_x: float | None
    axis_y: float | None
    axis_z: float | None
    revision: int
    is_reference: bool
    verdict: str | None
    judged_value: float | None
    reference: float | None
    deviation: float | None
    uncertainty: float | None
    expanded: float | None
    coverage_factor: float | None
    tolerance: float | None
    common: float | None
    common_sigma: float | None


MEASURED = (
    *("session_id", "at", "sensor", "kind", "parameter", "value", "u"),
    *("axis_x", "axis_y", "axis_z", "revision"),
)
JUDGED = (
    *("verdict", "value", "reference", "deviation", "uncertainty", "expanded"),
    *("coverage_factor", "tolerance", "common", "common_sigma"),
)
POINT = (
    *(getattr(ParameterRow, name) for name in MEASURED),
    SessionRow.is_reference,
    *(getattr(DecisionRow, name) for name in JUDGED),
)
"""The columns; decisions are joined from outside."""


def point_record(row: StoredPoint, *, raw: bool = False) -> HistoryPoint:
    """A stored parameter with the decision on it, or, ``raw``, with the common motion of the whole block left in."""
    seen = _LatestPoint(row, raw)
    value, u = seen.value, seen.u
    lower, upper = _band(row, value, u)
    return HistoryPoint(
        session=row.session,
        at=row.at,
        sensor=row.sensor,
        kind=row.kind,
        parameter=row.parameter,
        value=value,
        u=u,
        lower=lower,
        upper=upper,
        reference=row.reference,
        deviation=seen.deviation,
        expanded=seen.expanded,
        tolerance=_tolerance(row),
        verdict=Verdict.UNDECIDABLE if row.verdict is None else Verdict(row.verdict),
        is_reference=row.is_reference,
        axis=_axis(row),
        revision=row.revision,
    )


def _band(row: StoredPoint, value: float | None, u: float | None) -> tuple[float | None, float | None]:
    """value ± U; of a term of noise where it lies with 95 %."""
    if value is None or u is None:
        return None, None
    if row.parameter in TERMS:
        return interval_of(value, u)
    if row.coverage_factor is None:
        return None, None
    return value - row.coverage_factor * u, value + row.coverage_factor * u


@dataclass(frozen=True)
class _LatestPoint:
    """A parameter as it was judged, or as it was measured."""

    row: StoredPoint
    raw: bool

    @property
    def value(self) -> float | None:
        """Value of the parameter; for the axis the angle from the reference, without the turn of the whole block unless
        it is to stay.
        """
        row = self.row
        if row.parameter != "axis" or row.verdict is None:
            return row.value
        return row.judged_value if self.raw or row.deviation is None else row.deviation

    @property
    def u(self) -> float | None:
        """One sigma of the value."""
        row = self.row
        if row.parameter != "axis" or row.uncertainty is None:
            return row.u
        return hypot(row.uncertainty, self._together)

    @property
    def deviation(self) -> float | None:
        """Change from the reference."""
        row = self.row
        if row.common is None or not self.raw:
            return row.deviation
        if row.parameter == "axis":
            return row.judged_value
        return None if not row.reference or row.judged_value is None else row.judged_value / row.reference - 1

    @property
    def expanded(self) -> float | None:
        """U of the deviation."""
        row = self.row
        if row.expanded is None or row.coverage_factor is None:
            return None
        return hypot(row.expanded, row.coverage_factor * self._together)

    @property
    def _together(self) -> float:
        """One sigma of the common motion of the whole block, where that is left in."""
        return (self.row.common_sigma or 0.0) if self.raw else 0.0


def _tolerance(row: StoredPoint) -> float | None:
    """The tolerance in the unit of the value: a scale's tolerance is relative to its reference."""
    if row.parameter != "scale" or row.tolerance is None:
        return row.tolerance
    return None if row.reference is None else row.tolerance * abs(row.reference)


def _axis(row: StoredPoint) -> tuple[float, float, float] | None:
    if row.axis_x is None or row.axis_y is None or row.axis_z is None:
        return None
    return row.axis_x, row.axis_y, row.axis_z


@dataclass(frozen=True)
class HistoryQuery:
    """Part of a unit's history."""

    parameter: str | None = None
    sensor: str | None = None
    since: datetime | None = None
    until: datetime | None = None
    offset: int = 0
    limit: int = 10_000
    revision: int | None = None
    """Model revision, or the last one before it, of the calibrations; None for those in force."""
    newest: bool = False
    """Whether offset and limit count from the newest point back."""
    raw: bool = False
    """Whether the common motion of the whole block is left in."""
    noise: bool | None = False
    """Whether the terms of noise are wanted instead of the judged parameters; None for both. A parameter that is
    requested by its name is always included.
    """
    kind: str | None = None
    """Kind of the sensors."""


class History(Queries):
    """Parameters through time."""

    def add(self, unit: int, new: Iterable[tuple[StoredSession, Iterable[ParameterValue]]]) -> None:
        """Stores the parameters of sessions under their model revisions, sensor after sensor."""
        self.insert_many(ParameterRow, [row for record, values in new for row in _rows(unit, record, values)])

    def drop(self, record: StoredSession) -> None:
        """Removes the judged parameters of a session under its model revision: a recording moves another calibration
        now.
        """
        conditions = (ParameterRow.session_id == record.id, ParameterRow.revision == record.revision)
        self._session.execute(delete(ParameterRow).where(*conditions, IS_JUDGED))

    def points(self, unit: int, wanted: HistoryQuery) -> tuple[HistoryPoint, ...]:
        """The wanted part of a unit's history, oldest first, in one query."""
        query = (
            select(*POINT)
            .join(SessionRow, SessionRow.id == ParameterRow.session_id)
            .outerjoin(DecisionRow, DECIDED)
            .where(ParameterRow.unit_id == unit, SessionRow.unit_id == unit, IS_ACCEPTED)
            .where(ParameterRow.revision == _revision(wanted.revision))
        )
        if wanted.parameter is not None:
            query = query.where(ParameterRow.parameter == wanted.parameter)
        elif wanted.noise is not None:
            query = query.where(ParameterRow.parameter.in_(TERMS) if wanted.noise else IS_JUDGED)
        if wanted.kind is not None:
            query = query.where(ParameterRow.kind == wanted.kind)
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

    def latest(self, unit: int, *, raw: bool = False) -> tuple[HistoryPoint, ...]:
        """The newest point of every parameter of every sensor, and of every term of noise, in one query."""
        place = (ParameterRow.sensor, ParameterRow.kind, ParameterRow.parameter)
        known = select(*place).where(ParameterRow.unit_id == unit).distinct().subquery()
        own, session = aliased(ParameterRow), aliased(SessionRow)
        newest = (
            select(own.session_id)
            .join(session, (session.id == own.session_id) & (session.revision == own.revision))
            .where(own.unit_id == unit, session.state == RecordState.ACCEPTED)
            .where(own.sensor == known.c.sensor, own.kind == known.c.kind, own.parameter == known.c.parameter)
            .order_by(own.at.desc(), own.session_id.desc())
            .limit(1)
            .correlate(known)
            .scalar_subquery()
        )
        there = and_(*(column == known.c[column.key] for column in place), ParameterRow.session_id == newest)
        query = (
            select(*POINT)
            .select_from(known)
            .join(ParameterRow, there)
            .join(
                SessionRow, (SessionRow.id == ParameterRow.session_id) & (SessionRow.revision == ParameterRow.revision)
            )
            .outerjoin(DecisionRow, DECIDED)
        )
        return tuple(point_record(StoredPoint._make(row), raw=raw) for row in self._session.execute(query))

    def in_force(self, unit: int) -> dict[str, tuple[ParameterValue, ...]]:
        """The parameters of a unit's sessions under their revisions in force, by session."""
        names = ("sensor", "sensor_index", "kind", "parameter", "value", "u", "axis_x", "axis_y", "axis_z")
        columns = (getattr(ParameterRow, name) for name in names)
        in_force = (SessionRow.id == ParameterRow.session_id) & (SessionRow.revision == ParameterRow.revision)
        query = (
            select(ParameterRow.session_id, *columns)
            .join(SessionRow, in_force)
            .where(ParameterRow.unit_id == unit, SessionRow.unit_id == unit, IS_JUDGED)
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
        in_force = (ParameterRow.session_id == newest.c.id) & (ParameterRow.revision == newest.c.revision)
        rows = self._session.scalars(select(ParameterRow).join(newest, in_force).where(IS_JUDGED))
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
        in_force = (ParameterRow.session_id == wanted.c.id) & (ParameterRow.revision == wanted.c.revision)
        rows = self._session.execute(select(wanted.c.serial, ParameterRow).join(wanted, in_force).where(IS_JUDGED))
        found: dict[str, dict[tuple[str, str], ParameterValue]] = {}
        for serial, row in rows:
            found.setdefault(serial, {}).setdefault((row.sensor, row.parameter), _parameter_value(row))
        return found


def _rows(unit: int, record: StoredSession, values: Iterable[ParameterValue]) -> Iterator[dict[str, Any]]:
    key = {"session_id": record.id, "revision": record.revision, "unit_id": unit, "at": record.started_at}
    for value in values:
        x, y, z = value.axis or (None, None, None)
        seen = {name: getattr(value, name) for name in ("sensor", "sensor_index", "kind", "parameter", "value", "u")}
        yield {**key, **seen, "axis_x": x, "axis_y": y, "axis_z": z}


def _parameter_value(row: Any) -> ParameterValue:
    """The value in a row of `ParameterRow`, or in its columns."""
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
