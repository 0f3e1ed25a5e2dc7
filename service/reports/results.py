"""The judged parameters of a session as tables of a document: one a parameter and kind of sensor, in people's units."""

from collections.abc import Mapping
from dataclasses import dataclass

from estimator.results import Calibration, Estimate, SensorCalibration
from service.measures import (
    MINUS,
    THIN,
    UNKNOWN,
    Measure,
    decimals,
    deviation_measure,
    in_measure,
    limit,
    number,
    value_measure,
)
from service.records.decision import Decision
from service.records.session import ALL_PARAMETERS
from service.words.conditions import condition_of

HEADINGS = {
    "scale": "Scale factor",
    "bias": "Bias",
    "quadratic": "Quadratic term",
    "axis": "Input axis",
    "misalignment": "Misalignment to the turn axis",
}
UNSEEN = "not observable"


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
class ResultTable:
    """One parameter of all sensors of a kind."""

    heading: str
    value_measure: str
    deviation_measure: str
    tolerance: str
    rows: tuple[ResultRow, ...]


@dataclass(frozen=True)
class _Column:
    """What all rows of a table share."""

    parameter: str
    k: float
    value: Measure
    deviation: Measure


def result_tables(
    calibration: Calibration, reference: Calibration | None, decisions: tuple[Decision, ...], k: float
) -> tuple[ResultTable, ...]:
    """The tables of a session, parameters in their usual order."""
    judged = {(d.sensor, d.parameter): d for d in decisions}
    before = {} if reference is None else {sensor.name: sensor for sensor in reference.sensors}
    kinds = dict.fromkeys(sensor.kind for sensor in calibration.sensors)
    found = []
    for parameter in ALL_PARAMETERS:
        for kind in kinds:
            sensors = [s for s in calibration.sensors if s.kind == kind and parameter in s.observable]
            if sensors:
                title = f"{HEADINGS[parameter]}, {kind}s" if len(kinds) > 1 else HEADINGS[parameter]
                found.append(_table(title, parameter, sensors, before, judged, k))
    return tuple(found)


def _table(
    title: str,
    parameter: str,
    sensors: list[SensorCalibration],
    before: Mapping[str, SensorCalibration],
    judged: Mapping[tuple[str, str], Decision],
    k: float,
) -> ResultTable:
    decisions = [judged[s.name, parameter] for s in sensors if (s.name, parameter) in judged]
    column = _column(parameter, sensors, decisions, k)
    limits = dict.fromkeys(limit(d.tolerance, column.deviation, parameter == "axis") for d in decisions)
    return ResultTable(
        heading=title,
        value_measure="" if parameter == "axis" else column.value.label,
        deviation_measure=column.deviation.label,
        tolerance=" or ".join(limits),
        rows=tuple(_row(s, before.get(s.name), judged.get((s.name, parameter)), column) for s in sensors),
    )


def _column(parameter: str, sensors: list[SensorCalibration], decisions: list[Decision], k: float) -> _Column:
    """Units that suit the largest number of the table."""
    kind = sensors[0].kind
    moved = [abs(x) for d in decisions for x in (d.deviation, d.expanded, d.tolerance) if x is not None]
    if parameter == "axis":
        spreads = [k * s.axis_sigma for s in sensors if s.axis_sigma is not None]
        return _Column(parameter, k, *(deviation_measure(kind, "axis", max([*moved, *spreads], default=0.0)),) * 2)
    own = [abs(e.value) for s in sensors if (e := getattr(s, parameter)) is not None and e.value is not None]
    value = value_measure(kind, parameter, max(own, default=0.0))
    return _Column(parameter, k, value, deviation_measure(kind, parameter, max(moved, default=0.0)))


def _row(
    sensor: SensorCalibration, before: SensorCalibration | None, decision: Decision | None, column: _Column
) -> ResultRow:
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


def _value(sensor: SensorCalibration, column: _Column) -> tuple[str, str]:
    """The value and its U; a scale factor's is relative."""
    if column.parameter == "axis":
        if sensor.axis is None or sensor.axis_sigma is None:
            return UNSEEN, UNKNOWN
        vector = "\u2002".join(number(float(x), 6) for x in sensor.axis)
        return vector, _spread(column.k * sensor.axis_sigma, column.deviation)
    estimate: Estimate | None = getattr(sensor, column.parameter)
    if estimate is None or estimate.value is None or estimate.sigma is None:
        return UNSEEN, UNKNOWN
    expanded = column.k * estimate.sigma
    shown = number(in_measure(estimate.value, column.value), decimals(in_measure(expanded, column.value)))
    if column.parameter == "scale":
        return shown, _spread(abs(expanded / estimate.value), deviation_measure(sensor.kind, "scale", 0.0), label=True)
    return shown, _spread(expanded, column.value)


def _deviation(decision: Decision | None, column: _Column) -> str:
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
