"""The page of two sessions of a unit beside each other."""

from dataclasses import dataclass

from estimator.results import Calibration, SensorCalibration
from service.measures import measured
from service.pages.fleet import Margin, margin_of
from service.pages.session import (
    decision_measure,
    deviation_in_words,
    parameters_of,
    reading_units,
    tolerance_in_words,
    value_in_words,
)
from service.pages.session_lines import SessionLine, session_lines
from service.records.decision import Decision, nominal_factor_of
from service.records.session import ALL_PARAMETERS
from service.views.comparison import Comparison
from service.words.comparison import in_common
from service.words.conditions import Condition, condition_of
from service.words.motion import MotionLine, motions_in_words
from service.words.names import PARAMETER_NAMES

NOT_COMPARED = "not told by both"


@dataclass(frozen=True)
class ChangeRow:
    """One parameter of one sensor."""

    sensor: str
    parameter: str
    before: str
    after: str
    change: str
    on_one_stand: str
    """± of the change without what the stand does to both alike; empty where they have no stand in common."""
    tolerance: str
    used: Margin | None
    """How much of the tolerance the change uses, U included."""
    condition: Condition | None
    """None where the parameter is not judged, or not known of both."""


@dataclass(frozen=True)
class ComparisonPage:
    """Everything the page shows."""

    unit: str
    sessions: tuple[SessionLine, ...]
    """The earlier one, then the later one."""
    condition: Condition
    reason: str
    in_common: tuple[str, ...]
    motions: tuple[MotionLine, ...]
    rows: tuple[ChangeRow, ...]
    """By sensor, as they stand in the file."""
    has_own: bool
    """Whether both were measured on one stand."""
    coverage: str


def comparison_page(found: Comparison) -> ComparisonPage:
    """The page of a comparison."""
    judged = {(d.sensor, d.parameter): d for d in found.judged.decisions}
    k = nominal_factor_of(found.judged.decisions)
    earlier = {sensor.name: sensor for sensor in found.before.sensors}
    return ComparisonPage(
        unit=found.first.unit,
        sessions=session_lines((found.first, found.second)),
        condition=condition_of(found.judged.verdict),
        reason=found.judged.reason,
        in_common=in_common(found.first, found.second, found.services),
        motions=motions_in_words(found.judged.motions, k),
        rows=tuple(
            _row(earlier.get(sensor.name), sensor, parameter, judged.get((sensor.name, parameter)), (found, k))
            for sensor in found.after.sensors
            for parameter in _parameters(found.before, found.after)
        ),
        has_own=bool(found.own),
        coverage=f"k = {k:g}",
    )


def _parameters(before: Calibration, after: Calibration) -> tuple[str, ...]:
    """That either session speaks of."""
    told = {*parameters_of(before), *parameters_of(after)}
    return tuple(parameter for parameter in ALL_PARAMETERS if parameter in told)


def _row(
    then: SensorCalibration | None,
    now: SensorCalibration,
    parameter: str,
    decision: Decision | None,
    way: tuple[Comparison, float],
) -> ChangeRow:
    found, k = way
    units = reading_units(found.after)
    own = found.own.get((now.name, parameter))
    known = decision if decision is not None and decision.deviation is not None else None
    return ChangeRow(
        sensor=now.name,
        parameter=PARAMETER_NAMES[parameter],
        before="–" if then is None else value_in_words(then, parameter, k, units.get(now.name, "")),
        after=value_in_words(now, parameter, k, units.get(now.name, "")),
        change=NOT_COMPARED if known is None else deviation_in_words(known),
        on_one_stand="" if known is None or own is None else _own(known, own),
        tolerance=tolerance_in_words(decision),
        used=None if known is None else margin_of(known.margin),
        condition=None if known is None else condition_of(known.verdict),
    )


def _own(decision: Decision, spread: float) -> str:
    return f"± {measured(decision.coverage_factor * spread, None, decision_measure(decision))}"
