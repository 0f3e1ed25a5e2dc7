"""Parameters through time, one row a session, sensor and parameter."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from math import hypot

from sqlalchemy import ColumnElement, delete, func, select

from service.records.decision import Verdict
from service.records.history import HistoryPoint
from service.records.session import ParameterValue, StoredSession
from service.storage.queries.accepted import IS_ACCEPTED
from service.storage.queries.base import Queries
from service.storage.tables import CalibrationRow, DecisionRow, ParameterRow, SessionRow, UnitRow, UnitTypeRow

DECIDED = (
    (DecisionRow.session_id == ParameterRow.session_id)
    & (DecisionRow.revision == ParameterRow.revision)
    & (DecisionRow.sensor == ParameterRow.sensor)
    & (DecisionRow.parameter == ParameterRow.parameter)
)
"""The decision on a parameter, under the same model revision."""


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
            select(ParameterRow, DecisionRow, SessionRow.is_reference)
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
            point_record(*row, raw=wanted.raw)
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


def point_record(
    parameter: ParameterRow, decision: DecisionRow | None, is_reference: bool, *, raw: bool = False
) -> HistoryPoint:
    """A stored parameter with what was decided of it, or, ``raw``, with what the whole block did left in."""
    seen = _Seen(parameter, decision, raw)
    value, u = seen.value, seen.u
    expanded = None if u is None or decision is None else decision.coverage_factor * u
    return HistoryPoint(
        session=parameter.session_id,
        at=parameter.at,
        sensor=parameter.sensor,
        kind=parameter.kind,
        parameter=parameter.parameter,
        value=value,
        u=u,
        lower=None if value is None or expanded is None else value - expanded,
        upper=None if value is None or expanded is None else value + expanded,
        reference=None if decision is None else decision.reference,
        deviation=seen.deviation,
        expanded=seen.expanded,
        tolerance=None if decision is None else _tolerance(decision),
        verdict=Verdict.UNDECIDABLE if decision is None else Verdict(decision.verdict),
        is_reference=is_reference,
        axis=_axis(parameter),
        revision=parameter.revision,
    )


@dataclass(frozen=True)
class _Seen:
    """A parameter as it was judged, or as it was measured."""

    parameter: ParameterRow
    decision: DecisionRow | None
    raw: bool

    @property
    def value(self) -> float | None:
        """For the axis the angle from the reference, without the turn of the whole block unless it is to stay."""
        if self.parameter.parameter != "axis" or self.decision is None:
            return self.parameter.value
        judged = self.decision.deviation
        return self.decision.value if self.raw or judged is None else judged

    @property
    def u(self) -> float | None:
        """One sigma of the value."""
        if self.parameter.parameter != "axis" or self.decision is None or self.decision.uncertainty is None:
            return self.parameter.u
        return hypot(self.decision.uncertainty, self._together)

    @property
    def deviation(self) -> float | None:
        """From the reference."""
        own = self.decision
        if own is None or own.common is None or not self.raw:
            return None if own is None else own.deviation
        if self.parameter.parameter == "axis":
            return own.value
        return None if not own.reference or own.value is None else own.value / own.reference - 1

    @property
    def expanded(self) -> float | None:
        """U of the deviation."""
        own = self.decision
        if own is None or own.expanded is None:
            return None
        return hypot(own.expanded, own.coverage_factor * self._together)

    @property
    def _together(self) -> float:
        """One sigma of what the whole block did, where that is left in."""
        return (self.decision.common_sigma or 0.0) if self.raw and self.decision is not None else 0.0


def _tolerance(decision: DecisionRow) -> float | None:
    """In the unit of the value: a scale's tolerance is relative to its reference."""
    if decision.parameter != "scale":
        return decision.tolerance
    return None if decision.reference is None else decision.tolerance * abs(decision.reference)


def _axis(row: ParameterRow) -> tuple[float, float, float] | None:
    if row.axis_x is None or row.axis_y is None or row.axis_z is None:
        return None
    return row.axis_x, row.axis_y, row.axis_z
