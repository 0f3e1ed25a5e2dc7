"""One judged parameter of one sensor as a row of a document, in people's units."""

from dataclasses import dataclass

from estimator.results import Estimate, SensorCalibration
from service.kit.measures import MINUS, THIN, UNKNOWN, Measure, decimals, deviation_measure, in_measure, number
from service.sessions.decision import Decision
from service.sessions.words.conditions import condition_of

UNSEEN = "not observable"
"""Stands for a value that the session cannot tell."""


@dataclass(frozen=True)
class ResultRow:
    """One sensor."""

    sensor: str
    value: str
    expanded: str
    """U of the value."""
    reference: str
    deviation: str
    deviation_expanded: str
    """U of the deviation, of both sessions."""
    out: str
    """Probability that the true deviation is out of tolerance."""
    verdict: str
    key: str
    """Of the verdict's colour; empty where nothing is judged."""


@dataclass(frozen=True)
class ResultColumn:
    """What all rows of a table share."""

    parameter: str
    k: float
    value: Measure
    deviation: Measure


def result_row(
    sensor: SensorCalibration, before: SensorCalibration | None, decision: Decision | None, column: ResultColumn
) -> ResultRow:
    """The values of a sensor in the units of its table; without a reference, nothing before."""
    value, expanded = _value(sensor, column)
    condition = None if decision is None else condition_of(decision.verdict)
    return ResultRow(
        sensor=sensor.name,
        value=value,
        expanded=expanded,
        reference=UNKNOWN if before is None or column.parameter not in before.observable else _value(before, column)[0],
        deviation=_deviation(decision, column),
        deviation_expanded=_spread(None if decision is None else decision.expanded, column.deviation),
        out=_chance(decision),
        verdict="not judged" if condition is None else condition.formal,
        key="" if condition is None else condition.key,
    )


def _value(sensor: SensorCalibration, column: ResultColumn) -> tuple[str, str]:
    """The value and its U; a scale factor's is relative."""
    if column.parameter == "axis":
        if sensor.axis is None:
            return UNSEEN, UNKNOWN
        vector = "\u2002".join(number(float(x), 6) for x in sensor.axis)
        if sensor.axis_sigma is None:
            return vector, UNKNOWN
        return vector, _spread(sensor.factor("axis", column.k) * sensor.axis_sigma, column.deviation)
    estimate: Estimate | None = getattr(sensor, column.parameter)
    if estimate is None or estimate.value is None:
        return UNSEEN, UNKNOWN
    if estimate.sigma is None:
        return number(in_measure(estimate.value, column.value)), UNKNOWN
    expanded = estimate.factor(column.k) * estimate.sigma
    shown = number(in_measure(estimate.value, column.value), decimals(in_measure(expanded, column.value)))
    if column.parameter == "scale":
        return shown, _spread(abs(expanded / estimate.value), deviation_measure(sensor.kind, "scale", 0.0), label=True)
    return shown, _spread(expanded, column.value)


def _deviation(decision: Decision | None, column: ResultColumn) -> str:
    if decision is None or decision.deviation is None:
        return UNKNOWN
    shown = number(
        in_measure(decision.deviation, column.deviation), decimals(in_measure(decision.expanded, column.deviation))
    )
    return shown if column.parameter == "axis" or shown.startswith(MINUS) else f"+{shown}"


def _spread(si: float | None, unit: Measure, *, label: bool = False) -> str:
    """An expanded uncertainty with two significant digits."""
    shown = in_measure(si, unit)
    return number(shown, decimals(shown)) + (f"{THIN}{unit.label}" if label else "")


def _chance(decision: Decision | None) -> str:
    """``< 0.1 %``."""
    if decision is None or decision.probability_out is None:
        return UNKNOWN
    percent = 100 * decision.probability_out
    return "< 0.1 %" if percent < 0.1 else "> 99.9 %" if percent > 99.9 else f"{number(percent, 1)} %"
