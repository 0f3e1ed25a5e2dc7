"""One point of a history: a parameter with what was decided of it, column by column.

Histories have thousands of points: their columns are read, not whole rows as objects, and of a decision only those that
a point tells.
"""

from dataclasses import dataclass
from datetime import datetime
from math import hypot
from typing import NamedTuple

from estimator.allan.results import TERMS, interval_of
from service.records.decision import Verdict
from service.records.history import HistoryPoint
from service.storage.tables import DecisionRow, ParameterRow, SessionRow

DECIDED = (
    (DecisionRow.session_id == ParameterRow.session_id)
    & (DecisionRow.revision == ParameterRow.revision)
    & (DecisionRow.sensor == ParameterRow.sensor)
    & (DecisionRow.parameter == ParameterRow.parameter)
)
"""The decision on a parameter, under the same model revision."""
IS_JUDGED = ParameterRow.parameter.not_in(TERMS)
"""Parameters that a calibration gives: the terms of noise stand beside them and are never judged."""


class StoredPoint(NamedTuple):
    """What a query of points selects, in the order of `POINT`; what was decided is None where nothing was."""

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


POINT = (
    ParameterRow.session_id,
    ParameterRow.at,
    ParameterRow.sensor,
    ParameterRow.kind,
    ParameterRow.parameter,
    ParameterRow.value,
    ParameterRow.u,
    ParameterRow.axis_x,
    ParameterRow.axis_y,
    ParameterRow.axis_z,
    ParameterRow.revision,
    SessionRow.is_reference,
    DecisionRow.verdict,
    DecisionRow.value,
    DecisionRow.reference,
    DecisionRow.deviation,
    DecisionRow.uncertainty,
    DecisionRow.expanded,
    DecisionRow.coverage_factor,
    DecisionRow.tolerance,
    DecisionRow.common,
    DecisionRow.common_sigma,
)
"""The columns; decisions are joined from outside."""


def point_record(row: StoredPoint, *, raw: bool = False) -> HistoryPoint:
    """A stored parameter with what was decided of it, or, ``raw``, with what the whole block did left in."""
    seen = _Seen(row, raw)
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
class _Seen:
    """A parameter as it was judged, or as it was measured."""

    row: StoredPoint
    raw: bool

    @property
    def value(self) -> float | None:
        """For the axis the angle from the reference, without the turn of the whole block unless it is to stay."""
        own = self.row
        if own.parameter != "axis" or own.verdict is None:
            return own.value
        return own.judged_value if self.raw or own.deviation is None else own.deviation

    @property
    def u(self) -> float | None:
        """One sigma of the value."""
        own = self.row
        if own.parameter != "axis" or own.uncertainty is None:
            return own.u
        return hypot(own.uncertainty, self._together)

    @property
    def deviation(self) -> float | None:
        """From the reference."""
        own = self.row
        if own.common is None or not self.raw:
            return own.deviation
        if own.parameter == "axis":
            return own.judged_value
        return None if not own.reference or own.judged_value is None else own.judged_value / own.reference - 1

    @property
    def expanded(self) -> float | None:
        """U of the deviation."""
        own = self.row
        if own.expanded is None or own.coverage_factor is None:
            return None
        return hypot(own.expanded, own.coverage_factor * self._together)

    @property
    def _together(self) -> float:
        """One sigma of what the whole block did, where that is left in."""
        return (self.row.common_sigma or 0.0) if self.raw else 0.0


def _tolerance(row: StoredPoint) -> float | None:
    """In the unit of the value: a scale's tolerance is relative to its reference."""
    if row.parameter != "scale" or row.tolerance is None:
        return row.tolerance
    return None if row.reference is None else row.tolerance * abs(row.reference)


def _axis(row: StoredPoint) -> tuple[float, float, float] | None:
    if row.axis_x is None or row.axis_y is None or row.axis_z is None:
        return None
    return row.axis_x, row.axis_y, row.axis_z
