"""The judged parameters of a session as tables: one a parameter and kind of sensor, in practical units."""

from collections.abc import Mapping
from dataclasses import dataclass

from estimator.message import joined, say
from estimator.results import Estimate, SensorCalibration
from service.kit.measures import (
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
from service.kit.measures import heading as heading_of
from service.papers.certified import CertifiedSession
from service.sessions.decision import Decision
from service.sessions.records import ALL_PARAMETERS
from service.sessions.words.conditions import condition_of

NOT_OBSERVABLE = "not observable"
"""Text in place of a value that the session cannot determine."""


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
    """Key of the verdict's colour; empty where nothing is judged."""


@dataclass(frozen=True)
class ResultColumn:
    """Common to all rows of a table."""

    parameter: str
    k: float
    value: Measure
    deviation: Measure


def result_row(
    sensor: SensorCalibration, before: SensorCalibration | None, decision: Decision | None, column: ResultColumn
) -> ResultRow:
    """The values of a sensor in the units of its table; no reference values without a reference."""
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
        verdict="not judged" if condition is None else condition.word,
        key="" if condition is None else condition.key,
    )


def _value(sensor: SensorCalibration, column: ResultColumn) -> tuple[str, str]:
    if column.parameter == "axis":
        if sensor.axis is None:
            return NOT_OBSERVABLE, UNKNOWN
        vector = "\u2002".join(number(float(x), 6) for x in sensor.axis)
        if sensor.axis_sigma is None:
            return vector, UNKNOWN
        return vector, _spread(sensor.factor("axis", column.k) * sensor.axis_sigma, column.deviation)
    estimate: Estimate | None = getattr(sensor, column.parameter)
    if estimate is None or estimate.value is None:
        return NOT_OBSERVABLE, UNKNOWN
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


@dataclass(frozen=True)
class ResultTable:
    """One parameter of all sensors of a kind."""

    heading: str
    value_measure: str
    deviation_measure: str
    tolerance: str
    rows: tuple[ResultRow, ...]


@dataclass(frozen=True)
class _Results:
    before: Mapping[str, SensorCalibration]
    """The sensors of the reference by name; empty where there is none."""
    judged: Mapping[tuple[str, str], Decision]
    """Decisions by sensor and parameter; empty for a reference."""
    reading_units: Mapping[str, str]
    """Units of the readings, by sensor name."""
    counts: bool
    """Whether a gyro counts pulses over a known time."""
    k: float


def result_tables(found: CertifiedSession, k: float) -> tuple[ResultTable, ...]:
    """The tables of a session, parameters in their usual order."""
    results, sensors = _results(found, k), found.report.calibration.sensors
    kinds = dict.fromkeys(sensor.kind for sensor in sensors)
    groups = (
        (p, kind, [s for s in sensors if s.kind == kind and p in s.observable])
        for p in ALL_PARAMETERS
        for kind in kinds
    )
    return tuple(
        _table(
            say("{heading}, {kind}", heading=heading_of(parameter), kind=f"{kind}s")
            if len(kinds) > 1
            else heading_of(parameter),
            parameter,
            group,
            results,
        )
        for parameter, kind, group in groups
        if group
    )


def _results(found: CertifiedSession, k: float) -> _Results:
    decisions = () if found.report.session.is_reference else found.report.decisions
    before = () if found.reference is None else found.reference.calibration.sensors
    return _Results(
        before={sensor.name: sensor for sensor in before},
        judged={(d.sensor, d.parameter): d for d in decisions},
        reading_units={sensor.name: sensor.reading_unit for sensor in found.source.sensors},
        counts=bool(found.source.count_time),
        k=k,
    )


def _table(heading: str, parameter: str, sensors: list[SensorCalibration], results: _Results) -> ResultTable:
    decisions = [results.judged[s.name, parameter] for s in sensors if (s.name, parameter) in results.judged]
    column = _column(parameter, sensors, decisions, results.k)
    limits = dict.fromkeys(limit(d.tolerance, column.deviation, parameter == "axis") for d in decisions)
    rows = (result_row(s, results.before.get(s.name), results.judged.get((s.name, parameter)), column) for s in sensors)
    return ResultTable(
        heading=heading,
        value_measure="" if parameter == "axis" else _with_reading_unit(column.value.label, sensors, results),
        deviation_measure=column.deviation.label,
        tolerance=joined(" or ", limits),
        rows=tuple(rows),
    )


def _with_reading_unit(label: str, sensors: list[SensorCalibration], results: _Results) -> str:
    """``V per g`` where all sensors have the same reading unit."""
    units = {results.reading_units[s.name] for s in sensors if s.name in results.reading_units}
    if not label.startswith("per ") or len(units) != 1:
        return label
    rate = "/s" if results.counts and "°" in label else ""
    return say("{units}{rate} {label}", units=units.pop(), rate=rate, label=label)


def _column(parameter: str, sensors: list[SensorCalibration], decisions: list[Decision], k: float) -> ResultColumn:
    """Units that suit the largest number of the table."""
    kind = sensors[0].kind
    deviations = [abs(x) for d in decisions for x in (d.deviation, d.expanded, d.tolerance) if x is not None]
    if parameter == "axis":
        spreads = [s.factor("axis", k) * s.axis_sigma for s in sensors if s.axis_sigma is not None]
        return ResultColumn(
            parameter, k, *(deviation_measure(kind, "axis", max([*deviations, *spreads], default=0.0)),) * 2
        )
    values = [abs(e.value) for s in sensors if (e := getattr(s, parameter)) is not None and e.value is not None]
    value = value_measure(kind, parameter, max(values, default=0.0))
    return ResultColumn(parameter, k, value, deviation_measure(kind, parameter, max(deviations, default=0.0)))
