"""`imu-health calibrate`: session files to calibrations, without a server.

Tables are in µg, ppm, arcsec, °/h, and the agreement of model and readings in words.
"""

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from rich.columns import Columns
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table
from rich.text import Text

from estimator import calibrate
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import CORRECTED, CalibrationSession, Sensor
from service.commands.console import AsJson, Files, for_each, print_json, screen
from service.commands.speech import translated
from service.ingest import read_file
from service.kit.measures import (
    COVERAGE,
    UNKNOWN,
    coverage_in_words,
    deviation_measure,
    in_measure,
    measured,
    method_name,
    number,
)
from service.sessions.words.curves import curves_in_words
from service.sessions.words.readings import fit_in_words

NOT_OBSERVABLE = "not observable"
"""Text in place of a value that the session does not observe."""
Result = tuple[CalibrationSession, Calibration]


def calibrate_files(files: Files, as_json: AsJson = False) -> None:
    """Calibrate session files: scale factor, bias, quadratic term and axis of every sensor, with uncertainties."""
    for_each(files, _calibrated, _print_json if as_json else _print_table, "calibrating", quiet=as_json)


def _calibrated(file: Path) -> Result:
    session = read_file(file)
    return session, calibrate(session)


def _print_json(result: Result) -> None:
    print_json(result[1].to_dict())


def _print_table(result: Result) -> None:
    screen().print(calibration_view(*result))


def calibration_view(session: CalibrationSession, calibration: Calibration) -> RenderableType:
    """The whole calibration of one session; ± is U, the stand's errors included."""
    parts = (_heading(session, calibration), _parameters(session, calibration), *temperature_view(calibration))
    return Group(*parts, *_notes(calibration), Text(""))


def temperature_view(calibration: Calibration) -> Iterator[RenderableType]:
    """Scale factors and biases over temperature in a thermal session."""
    curves = curves_in_words(calibration)
    if curves is None:
        return
    yield Text(f"Over temperature: changes from {curves.reference}, where all other values hold, ± U of the value")
    table = _table("sensor", "parameter", "order", f"at {curves.lowest}", f"at {curves.highest}")
    for row in curves.rows:
        table.add_row(escape(row.sensor), row.parameter, str(row.order), row.cold, row.hot)
    yield table
    yield from (Text(translated(line), "yellow") for line in curves.findings)


def _heading(session: CalibrationSession, calibration: Calibration) -> Text:
    place = f" on {session.stand.id}" if session.stand else ""
    when = f", {session.started_at}" if session.started_at else ""
    coverage = coverage_in_words(calibration, COVERAGE)
    return Text.assemble(
        (session.unit, "bold"), f"{when}{place}: {method_name(calibration.method)}; ± is U, {coverage}, all sources"
    )


def _parameters(session: CalibrationSession, calibration: Calibration) -> RenderableType:
    """Two tables of one row a sensor: side by side where the screen is wide enough."""
    if session.programme not in CORRECTED:
        return _axes_of_block(calibration)
    numbers = _table("sensor", "scale, off nominal", "bias", "quadratic")
    axes = _table("sensor", "axis, block axes", "±")
    for declared, sensor in zip(session.sensors, calibration.sensors, strict=True):
        numbers.add_row(escape(sensor.name), *_numbers(declared, sensor))
        axes.add_row(escape(sensor.name), *_axis(sensor))
    return Columns([numbers, axes], padding=(0, 3))


def _axes_of_block(calibration: Calibration) -> RenderableType:
    """One table of one row an axis of the block, for sessions on a turntable."""
    table = _table("axis", "scale, off 1", "bias", "misalignment")
    for sensor in calibration.sensors:
        off = _off_nominal(sensor.scale, 1.0)
        estimates = {"scale": off, "bias": sensor.bias, "misalignment": sensor.misalignment or off}
        cells = (_cell(sensor, name, estimate) for name, estimate in estimates.items())
        table.add_row(escape(sensor.name), *cells)
    return table


def _cell(sensor: SensorCalibration, parameter: str, estimate: Estimate) -> str:
    """The value with U; empty where the session does not concern the parameter."""
    if parameter not in sensor.observable:
        return ""
    if estimate.value is None:
        return NOT_OBSERVABLE
    return measured(estimate.value, _expanded(estimate), deviation_measure(sensor.kind, parameter, estimate.value))


def _table(*headings: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for place, heading in enumerate(headings):
        table.add_column(heading, justify="right" if place else "left", no_wrap=True)
    return table


def _numbers(declared: Sensor, sensor: SensorCalibration) -> Iterator[str]:
    off = _off_nominal(sensor.scale, declared.nominal_scale)
    for parameter, estimate in (("scale", off), ("bias", sensor.bias), ("quadratic", sensor.quadratic)):
        unit = deviation_measure(sensor.kind, parameter, estimate.value or 0.0)
        yield NOT_OBSERVABLE if estimate.value is None else measured(estimate.value, _expanded(estimate), unit)


def _axis(sensor: SensorCalibration) -> tuple[str, str]:
    if sensor.axis is None:
        return NOT_OBSERVABLE, ""
    if sensor.axis_sigma is None:
        return " ".join(number(x, 6) for x in sensor.axis), UNKNOWN
    expanded = sensor.factor("axis") * sensor.axis_sigma
    unit = deviation_measure(sensor.kind, "axis", expanded)
    return " ".join(number(x, 6) for x in sensor.axis), f"{number(in_measure(expanded, unit), 1)} {unit.label}"


def _expanded(estimate: Estimate) -> float | None:
    """U; None where the noise is unknown."""
    return None if estimate.sigma is None else estimate.factor() * estimate.sigma


def _off_nominal(scale: Estimate, nominal: float) -> Estimate:
    """The scale factor relative to the nominal one."""
    if scale.value is None:
        return scale
    return replace(scale, value=scale.value / nominal - 1, sigma=None if scale.sigma is None else scale.sigma / nominal)


def _notes(calibration: Calibration) -> Iterator[Text]:
    """Sentences: agreement of model and readings, and what this session cannot see."""
    fit = fit_in_words(calibration)
    yield Text(f"{translated(fit.headline)} {translated(fit.detail)}")
    sensors: dict[str, list[str]] = {}
    for sensor in calibration.sensors:
        unseen = ", ".join(name for name, seen in sensor.observable.items() if not seen)
        sensors.setdefault(unseen, []).append(sensor.name)
    for unseen, names in sensors.items():
        if unseen:
            yield Text(f"{', '.join(names)}: this session does not observe {unseen}.", "yellow")
    for warning in fit.warnings:
        yield Text(translated(warning), "yellow")
