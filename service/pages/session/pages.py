"""The page of one session: the verdict and its reasons, the parameters behind it, and the agreement of model and
readings.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from estimator.message import say, without_stop
from estimator.parity import ParityResult
from estimator.reading.sensors import PULSES
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import CORRECTED
from service.diagnosis.sections import DiagnosisLine, diagnosis_line
from service.diagnosis.words.causes import cause_on
from service.judging.covered import CoveredTemperatures
from service.judging.parity_words import agreement_in_words
from service.judging.sections import ParityView, parity_view
from service.judging.temperature_words import covered_in_words, laws_in_words, span_in_words
from service.kit.measures import (
    HARD,
    THIN,
    Measure,
    coverage_in_words,
    decimals,
    deviation_measure,
    in_measure,
    limit,
    measured,
    method_name,
    number,
    signed,
    size_in_words,
    value_measure,
)
from service.models.records import ModelRevision
from service.pages.unit.remarks import Remarks
from service.papers.certified import SessionReport
from service.papers.records import Traceability
from service.sessions.charts import ChartSet, noise_of
from service.sessions.course_charts import charts_of_fit
from service.sessions.curve_charts import curve_charts
from service.sessions.decision import Decision, Verdict, nominal_factor_of
from service.sessions.doubt import Remedies, Reservations
from service.sessions.lines import ResidualTable, residual_table
from service.sessions.records import ALL_PARAMETERS, DiagnosisSummary, StoredSession
from service.sessions.states import RecordState
from service.sessions.words.conditions import MEANINGS, STATES, Condition, condition_of, state_in_words
from service.sessions.words.curves import CurvesInWords, curves_in_words
from service.sessions.words.motion import MotionLine, motions_in_words
from service.sessions.words.readings import (
    FitWords,
    answer_in_words,
    bands_in_words,
    beside_screening,
    combination_in_words,
    fit_in_words,
    switched_on,
)

NOTHING_KNOWN = Remedies()
"""Remedies of a session that counts."""


FORCE = "g_sensitivity"
"""Found of gyros that plainly have one; nothing judges it."""


@dataclass(frozen=True)
class ParameterCell:
    """One parameter of one sensor."""

    parameter: str
    observable: bool
    value: str
    deviation: str
    tolerance: str
    probability: str
    condition: Condition | None
    """Condition of the decision; None where there is none."""


@dataclass(frozen=True)
class SensorRow:
    """One sensor."""

    name: str
    kind: str
    cells: tuple[ParameterCell, ...]
    known: tuple[str, ...]
    """Combinations of parameters that are known where the session cannot tell the parameters apart."""


@dataclass(frozen=True)
class SessionView:
    """Everything a session's page shows."""

    session: StoredSession
    condition: Condition
    reservations: Reservations
    parameters: tuple[str, ...]
    """Parameters of every row's cells, in their order."""
    sensors: tuple[SensorRow, ...]
    fit: FitWords
    parity: ParityView | None
    """View of parity, for a recording in service only."""
    curves: CurvesInWords | None
    """Curves over temperature, for a thermal session only."""
    curve_charts: tuple[ChartSet, ...]
    charts: tuple[ChartSet, ...]
    bands: str
    """Explanation of the drawn bands of noise."""
    residuals: ResidualTable
    method: str
    rule: str
    coverage: str
    size: str
    temperature: str
    """Temperature of its readings."""
    covered: str
    """The temperatures that the unit's calibrations up to it cover."""
    switched_on: str
    """Time from switching on to the first reading; empty where the file does not state it."""
    diagnosis: DiagnosisLine
    gives_correction: bool
    """Whether its programme calibrates every sensor of the block."""
    motions: tuple[MotionLine, ...]
    """Motions common to all sensors, in words."""
    laws: tuple[str, ...]
    """Corrections for its temperature, in words."""
    state: str
    """State, shown before everything else; empty where it counts."""
    states: tuple[str, ...]
    """Changes of state, newest first."""
    remedies: Remedies
    """Ways to put it right, where it is questioned."""
    traceability: Traceability | None
    """Traceability of its results."""
    said: Remarks | None
    """Remarks of people on it; None where the page is made without a service."""
    follow: int | None
    """Seconds after which the page looks again whether it is diagnosed; None where it is."""
    retired: str = ""
    """Remark that its unit is retired, with the date; empty where it is in use."""
    no_tolerances: str = ""
    """The type of its unit, where nobody has entered its tolerances."""
    causes: tuple[str, ...] = ()
    """Causes in the model of its calibration in force."""
    earlier: tuple[int, ...] = ()
    """Model revisions that it was calibrated under before."""


def session_page(
    report: SessionReport,
    diagnosis: DiagnosisSummary | None = None,
    traceability: Traceability | None = None,
    *,
    remedies: Remedies = NOTHING_KNOWN,
    failed: str = "",
    follow: int | None = None,
    model: Sequence[ModelRevision] = (),
    computed: Sequence[int] = (),
    said: Remarks | None = None,
    retired: str = "",
    temperatures: CoveredTemperatures | None = None,
    no_tolerances: str = "",
) -> SessionView:
    """The page of a session; ``model``: the causes that it was calibrated with, ``computed``: under which revisions."""
    calibration, decisions = report.calibration, report.decisions
    units = reading_units(calibration)
    judged = {(d.sensor, d.parameter): d for d in decisions}
    parameters = parameters_of(calibration)
    if any(sensor.g_sensitivity is not None for sensor in calibration.sensors):
        parameters = (*parameters, FORCE)
    coverage = nominal_factor_of(decisions)
    noise = noise_of(calibration.residuals, calibration)
    parity = None if calibration.parity is None else ParityResult.from_dict(calibration.parity)
    return SessionView(
        session=report.session,
        condition=condition_of(report.session.verdict, is_reference=report.session.is_reference),
        reservations=report.session.reservations,
        parameters=parameters,
        sensors=tuple(_sensor(s, parameters, judged, (coverage, units.get(s.name, ""))) for s in calibration.sensors),
        fit=fit_in_words(calibration) if parity is None else beside_screening(agreement_in_words(parity), calibration),
        parity=None if parity is None else parity_view(parity),
        curves=curves_in_words(calibration),
        curve_charts=curve_charts(calibration),
        charts=charts_of_fit(calibration),
        bands=bands_in_words(calibration, noise.times),
        residuals=residual_table(calibration),
        method=method_name(calibration.method),
        rule=decisions[0].rule if decisions else "",
        coverage=coverage_in_words(calibration, coverage),
        size=size_in_words(report.session.size),
        temperature=span_in_words(calibration.residuals.temperature),
        covered=covered_in_words(temperatures),
        switched_on=switched_on(report.session.time_since_power_on),
        diagnosis=diagnosis_line(diagnosis, failed),
        gives_correction=report.session.programme in CORRECTED,
        motions=motions_in_words(report.motions, coverage),
        laws=laws_in_words(decisions),
        state=_state(report),
        states=tuple(state_in_words(line) for line in reversed(report.states)),
        remedies=remedies,
        traceability=traceability,
        said=said,
        follow=follow,
        retired=retired,
        no_tolerances=no_tolerances,
        causes=tuple(cause_on(revision.cause, revision.sensors) for revision in model),
        earlier=tuple(revision for revision in computed if revision != report.session.revision),
    )


def _state(report: SessionReport) -> str:
    state = report.session.state
    if state is RecordState.ACCEPTED:
        return ""
    said = state_in_words(report.states[-1]) if report.states else STATES[state]
    return say("{verdict}. {meaning}", verdict=without_stop(said), meaning=MEANINGS[state])


def parameters_of(calibration: Calibration) -> tuple[str, ...]:
    """The parameters that a session concerns."""
    return tuple(p for p in ALL_PARAMETERS if any(p in sensor.observable for sensor in calibration.sensors))


def _sensor(
    sensor: SensorCalibration,
    parameters: tuple[str, ...],
    judged: Mapping[tuple[str, str], Decision],
    coverage_and_unit: tuple[float, str],
) -> SensorRow:
    """``coverage_and_unit``: coverage factor and reading unit."""
    return SensorRow(
        name=sensor.name,
        kind=sensor.kind,
        cells=tuple(_cell(sensor, p, judged.get((sensor.name, p)), coverage_and_unit) for p in parameters),
        known=tuple(combination_in_words(k, sensor.kind) for k in sensor.known),
    )


def _cell(
    sensor: SensorCalibration, parameter: str, decision: Decision | None, coverage_and_unit: tuple[float, str]
) -> ParameterCell:
    return ParameterCell(
        parameter=parameter,
        observable=parameter == FORCE or sensor.observable.get(parameter, False),
        value=value_in_words(sensor, parameter, *coverage_and_unit),
        deviation=deviation_in_words(decision),
        tolerance=tolerance_in_words(decision),
        probability=_probability(decision),
        condition=None if decision is None else condition_of(decision.verdict),
    )


def reading_units(calibration: Calibration) -> dict[str, str]:
    """Reading unit of each sensor, from the unit of its scale factor, ``V/(m/s²)``; pulses are counted over time."""
    units = dict(zip(calibration.names, calibration.units, strict=True))
    found = {s.name: units.get(f"{s.name}.scale", "").partition("/(")[::2] for s in calibration.sensors}
    return {name: f"{unit}/s" if unit.lower() in PULSES else unit for name, (unit, per) in found.items() if per}


def value_in_words(sensor: SensorCalibration, parameter: str, coverage: float, reading_unit: str) -> str:
    """A parameter ± U, or that it is not observable; empty where the session does not concern it."""
    if parameter == FORCE:
        return "" if sensor.g_sensitivity is None else answer_in_words(sensor.g_sensitivity, coverage)
    if not sensor.observable.get(parameter, False):
        return "not observable" if parameter in sensor.observable else ""
    if parameter == "axis":
        return _axis(sensor, coverage)
    estimate: Estimate = getattr(sensor, parameter)
    spread = None if estimate.sigma is None else estimate.factor(coverage) * estimate.sigma
    if parameter == "scale":
        return _scale(estimate.value, spread, sensor.kind, reading_unit)
    largest = max(abs(estimate.value or 0.0), spread or 0.0)
    return measured(estimate.value, spread, value_measure(sensor.kind, parameter, largest))


def _scale(value: float | None, spread: float | None, kind: str, reading_unit: str) -> str:
    """A scale factor is read with its relative uncertainty: ``1.1792038 V per g ± 4.0 ppm``."""
    plain = value_measure(kind, "scale", 0.0)
    measure = Measure(
        say("{unit} {label}", unit=reading_unit, label=plain.label) if reading_unit else plain.label, plain.factor
    )
    if value is None or not spread or not value:
        return measured(value, None, measure)
    relative = deviation_measure(kind, "scale", spread / abs(value))
    share = spread / abs(value) * relative.factor
    shown = number(in_measure(value, measure), decimals(in_measure(spread, measure)))
    return f"{shown} " + measure.label + f" ±{HARD}{number(share, decimals(share))}{THIN}{relative.label}"


def _axis(sensor: SensorCalibration, coverage: float) -> str:
    if sensor.axis is None:
        return "not observable"
    vector = ", ".join(number(float(x), 6) for x in sensor.axis)
    if sensor.axis_sigma is None:
        return f"({vector})"
    spread = sensor.factor("axis", coverage) * sensor.axis_sigma
    measure = deviation_measure(sensor.kind, "axis", spread)
    share = spread * measure.factor
    return f"({vector}) ±{HARD}{number(share, decimals(share))}{THIN}{measure.label}"


def decision_measure(decision: Decision) -> Measure:
    """The measure for deviation, uncertainty and tolerance together."""
    sizes = (decision.deviation, decision.expanded, decision.tolerance)
    return deviation_measure(decision.kind, decision.parameter, max(abs(x or 0.0) for x in sizes))


def deviation_in_words(decision: Decision | None) -> str:
    """The change ± U."""
    if decision is None or decision.deviation is None:
        return ""
    write = measured if decision.parameter == "axis" else signed
    return write(decision.deviation, decision.expanded, decision_measure(decision))


def tolerance_in_words(decision: Decision | None) -> str:
    """``±40 µg``."""
    if decision is None:
        return ""
    return limit(decision.tolerance, decision_measure(decision), decision.parameter == "axis")


def _probability(decision: Decision | None) -> str:
    """Worth a word only where it is in doubt."""
    if decision is None or decision.probability_out is None or decision.verdict in (Verdict.PASS, Verdict.FAIL):
        return ""
    percent = 100 * decision.probability_out
    words = "more than 99" if percent > 99 else "less than 1" if percent < 1 else f"{percent:.0f}"
    return say("{probability} % chance to be out", probability=words)
