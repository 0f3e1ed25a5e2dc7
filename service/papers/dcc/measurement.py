"""Method, equipment and results: a sensor a result, every value with U and its decision."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.results import SensorCalibration
from estimator.session import ACCELEROMETER
from service.kit.measures import spaced
from service.kit.printable import Element
from service.papers.certified import StatedSession
from service.papers.dcc.administrative import conditions
from service.papers.dcc.elements import (
    DCC,
    ONE,
    SI,
    CoverageFactor,
    bare_quantity,
    conformity,
    deviation_measure,
    english,
    plain,
    quantity,
    software,
    value_measure,
)
from service.papers.words import title_of
from service.sessions.decision import Decision, nominal_factor_of

FACTOR = re.compile(r"((?:\\milli)?\\(?!milli|tothe|one)[a-z]+)(?:\\tothe\{(-?\d+)\})?")
"""One unit of a product in D-SI, with its exponent."""
TOTAL = "Covariance of all parameters"
COVARIANCE_OF, PROBABILITY = "covariance of ", "probability of being out of tolerance"
"""Names of quantities."""
TRIANGLE = "Each entry with itself and those after it: the matrix is symmetric. Labels name the other parameter."


def covariance(found: StatedSession) -> Element | None:
    """Total covariance of the observed parameters; None where the noise is unknown."""
    calibration, units = found.report.calibration, _units(found)
    matrix = np.asarray(calibration.covariance, dtype=float)
    observed = [k for k, unit in enumerate(units) if unit and np.isfinite(matrix[k, k])]
    if not observed:
        return None
    rows = (
        _row(
            calibration.names[k],
            [
                CovarianceEntry(_word(calibration.names[j]), matrix[k, j], product(units[k], units[j]))
                for j in observed[place:]
            ],
        )
        for place, k in enumerate(observed)
    )
    data = DCC.data(*(part for row in rows for part in row))
    return DCC.result(english("name", TOTAL), english("description", TRIANGLE), data)


@dataclass(frozen=True)
class CovarianceEntry:
    """One element of the covariance."""

    label: str
    """The other parameter."""
    value: float
    unit: str


def _row(name: str, entries: Sequence[CovarianceEntry]) -> Iterator[Element]:
    """The covariances of one parameter, a list for each unit."""
    for unit in dict.fromkeys(entry.unit for entry in entries):
        same_unit = [entry for entry in entries if entry.unit == unit]
        numbers = SI.realListXMLList(
            SI.labelXMLList(" ".join(entry.label for entry in same_unit)),
            SI.valueXMLList(" ".join(repr(float(entry.value)) for entry in same_unit)),
            SI.unitXMLList(unit),
        )
        yield DCC.quantity(english("name", f"{COVARIANCE_OF}{name}"), numbers)


def _units(found: StatedSession) -> list[str]:
    """D-SI of every element of the covariance; empty where it belongs to no sensor."""
    kinds = {sensor.name: sensor.kind for sensor in found.report.calibration.sensors}
    readings = {sensor.name: sensor.reading_unit for sensor in found.source.sensors}
    counts = found.source.count_time is not None
    units = []
    for name in found.report.calibration.names:
        sensor, _, element = name.rpartition(".")
        kind = kinds.get(sensor, "")
        counted = counts and kind != ACCELEROMETER
        units.append(value_measure(kind, element, readings.get(sensor, ""), counted=counted) if kind else "")
    return units


def product(first: str, second: str) -> str:
    """The product of two units in D-SI, every unit once."""
    powers: Counter[str] = Counter()
    for unit, power in FACTOR.findall(first) + FACTOR.findall(second):
        powers[unit] += int(power or 1)
    factors = (unit if power == 1 else f"{unit}\\tothe{{{power}}}" for unit, power in powers.items() if power)
    return "".join(factors) or ONE


def _word(name: str) -> str:
    return "_".join(plain(name).split())


def measurement(found: StatedSession) -> Element:
    """The one measurement result of a session."""
    session, calibration = found.report.session, found.report.calibration
    covariances = covariance(found)
    decisions = {(d.sensor, d.parameter): d for d in found.report.decisions if not session.is_reference}
    return DCC.measurementResult(
        english("name", f"{title_of(session)}: {spaced(session.programme)}"),
        DCC.usedMethods(*_methods(found)),
        DCC.usedSoftware(software(found.software)),
        *_equipment(found),
        conditions(found.source),
        DCC.results(
            *(_result(sensor, found, decisions) for sensor in calibration.sensors),
            *(() if covariances is None else (covariances,)),
        ),
    )


def _methods(found: StatedSession) -> Iterator[Element]:
    """Methods of measurement, uncertainty and decision, with their versions."""
    session, calibration = found.report.session, found.report.calibration
    model = (
        f"Model revision {session.revision}; block axes held by {calibration.gauge}; "
        f"computed by imu-health, version {found.software}."
    )
    yield DCC.usedMethod(english("name", calibration.method), english("description", model))
    yield DCC.usedMethod(english("name", "Evaluation of uncertainty"), DCC.norm("EA-4/02"))
    if found.report.decisions and not session.is_reference:
        rule = f"{found.report.decisions[0].rule}; guard band w = U"
        yield DCC.usedMethod(english("name", "Decision rule"), english("description", rule), DCC.norm("ILAC-G8"))


def _equipment(found: StatedSession) -> Iterator[Element]:
    """The stand, with the number of its certificate where one is on record."""
    stand, certificate = found.source.stand, found.traceability.certificate
    if stand is None:
        return
    numbered = []
    if certificate is not None:
        name = english("name", f"Certificate of the stand, issued by {certificate.issued_by}")
        numbered = [DCC.identification(DCC.issuer("other"), DCC.value(certificate.number), name)]
    yield DCC.measuringEquipments(
        DCC.measuringEquipment(
            english("name", f"Stand {stand.id}"),
            english("description", found.traceability.text),
            *(DCC.identifications(number) for number in numbered),
        )
    )


def _result(sensor: SensorCalibration, found: StatedSession, decisions: Mapping[tuple[str, str], Decision]) -> Element:
    data = DCC.data()
    for parameter, is_observable in sensor.observable.items():
        text = english("text", f"{parameter}: not observable in this session")
        data.append(_value(sensor, parameter, found) if is_observable else text)
        decision = decisions.get((sensor.name, parameter))
        if decision is not None and decision.deviation is not None:
            data.append(_deviation(decision, decision.deviation))
    return DCC.result(english("name", f"{sensor.kind} {sensor.name}"), data)


def _value(sensor: SensorCalibration, parameter: str, found: StatedSession) -> Element:
    k = sensor.factor(parameter, nominal_factor_of(found.report.decisions))
    if parameter == "axis":
        return _axis(sensor, k)
    estimate = getattr(sensor, parameter)
    declared = next((s for s in found.source.sensors if s.name == sensor.name), None)
    reading = "" if declared is None else declared.reading_unit
    counted = found.source.count_time is not None and sensor.kind != ACCELEROMETER
    unit = value_measure(sensor.kind, parameter, reading, counted=counted)
    name = f"{parameter}, in {reading or '1'} per input" if parameter == "scale" else parameter
    return quantity(name, estimate.value, unit, estimate.sigma, CoverageFactor(k, estimate.dof))


def _axis(sensor: SensorCalibration, k: float) -> Element:
    """Three components; the uncertainty is that of the direction along each of them."""
    assert sensor.axis is not None
    spread = np.sqrt(np.diag(sensor.axis_tangents @ sensor.axis_covariance @ sensor.axis_tangents.T))
    components = zip("xyz", sensor.axis, spread, strict=True)
    return DCC.list(
        english("name", "input axis, block axes"),
        *(
            quantity(name, value, ONE, _known(sigma), CoverageFactor(k, sensor.axis_dof))
            for name, value, sigma in components
        ),
    )


def _known(sigma: float) -> float | None:
    """NaN, of a session with unknown noise, is no uncertainty."""
    return float(sigma) if np.isfinite(sigma) else None


def _deviation(decision: Decision, deviation: float) -> Element:
    """The deviation with its decision."""
    unit, k = (
        deviation_measure(decision.kind, decision.parameter),
        CoverageFactor(decision.coverage_factor, decision.dof),
    )
    name = f"{decision.parameter}, deviation from the reference"
    element = quantity(name, deviation, unit, decision.uncertainty, k)
    metadata = DCC.metaData(
        english("declaration", f"{decision.rule}: {decision.verdict.value}"),
        *conformity(decision.verdict),
        DCC.data(*_limits(decision, unit)),
    )
    element.append(DCC.measurementMetaData(metadata))
    return element


def _limits(decision: Decision, unit: str) -> Iterator[Element]:
    """Limits of the decision, and the correction before it."""
    step = decision.temperature_correction
    if step is not None:
        name = f"deviation at {step.temperature:.1f} °C, before the law of {step.sessions} sessions over temperature"
        yield bare_quantity(name, step.measured, unit)
        yield bare_quantity(f"taken off for {step.reference_temperature:.1f} °C", step.worth, unit)
    yield bare_quantity("tolerance", decision.tolerance, unit)
    if decision.guard_band is not None:
        yield bare_quantity("guard band", decision.guard_band, unit)
    if decision.probability_out is not None:
        yield bare_quantity(PROBABILITY, decision.probability_out, ONE)
