"""The correction from a session's calibration, for firmware: formula, numbers and a worked example."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.applied_vector import magnitude, stand_geometry
from estimator.calibration.calibrate import averaged
from estimator.codec import json_numbers
from estimator.correction import BlockCorrection, Correction, SensorCorrection, at_temperature, correction_of
from estimator.curves import ThermalCurves
from estimator.health.temperature_law import NO_STEPS, Steps, TemperatureStep
from estimator.json_object import Json
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, CORRECTED, TWO_AXIS_STAND, Array, CalibrationSession
from service.errors import NotFoundError
from service.ingest import read_upload
from service.judging.covered import CoveredTemperatures
from service.judging.reference import covered_at
from service.kit.measures import COVERAGE
from service.models.records import ModelRevision
from service.models.store import Models, evidence_to_dict
from service.sessions.calibrations_store import Calibrations
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage

FORMULA = (
    "y = (reading - offset) / (count_time * scale) - bias, with count_time = 1 where it is null",
    "a = 2 * y / (1 + sqrt(1 + 4 * quadratic * y)), the component along the sensor's axis",
    "vector = matrix * a, over the sensors in the order of the block, in block axes",
)
"""Sensor model solved for the input, step by step, as firmware computes it."""
OVER_TEMPERATURE = (
    "dT = temperature - reference_temperature_c, the temperature in degrees Celsius held within temperature_range_c",
    "scale = sum of scale_over_temperature[k] * dT^k where it is given, bias = sum of bias_over_temperature[k] * dT^k",
)
"""Comes first where the session holds curves over temperature."""
ALWAYS_LEFT = (
    "noise of the single reading",
    "nonlinearity beyond the quadratic term, asymmetry, hysteresis, cross-coupling",
)
"""Errors that no such correction can remove."""
ONE_TEMPERATURE = "temperature: the parameters are those at the session's temperature"
BEYOND_RANGE = "temperature outside the range of the session, hysteresis and lag"
"""Remaining errors of temperature, for a session without curves over temperature and for one with them."""
DIGITS = 9
"""Significant digits of the worked example's numbers in words."""


@dataclass(frozen=True, eq=False)
class Corrected:
    """A stored session with its correction."""

    stored: StoredSession
    calibration: Calibration
    session: CalibrationSession
    """Averaged."""
    found: Correction
    revisions: tuple[ModelRevision, ...]
    """Accepted causes in the estimation of the parameters."""
    steps: Steps
    """Effects of the session's temperature on the parameters, where a law is known."""
    temperatures: CoveredTemperatures | None
    """Temperatures covered by the unit's calibrations up to this one."""


def corrected(storage: Storage, id: str) -> Corrected:
    """The correction of a session; NotFoundError where its programme gives none."""
    with storage.database.reading() as store:
        stored, calibration = Sessions(store).get(id), Calibrations(store).get(id)
        revisions = tuple(r for r in Models(store).of_session(id) if r.id <= stored.revision)
        steps = Sessions(store).temperature_steps((id,)).get(id, NO_STEPS)
        temperatures = covered_at(store, stored)
    if stored.programme not in CORRECTED:
        raise NotFoundError(f"Session {id!r} gives no correction: {stored.programme} does not calibrate a block.")
    session = averaged(read_upload(storage.files.content(stored.sha256), stored.filename), CORRECTED)
    correction = correction_of(session, calibration)
    if not correction.blocks:
        raise NotFoundError(f"Session {id!r} gives no correction: {'; '.join(_reasons(correction))}.")
    return Corrected(stored, calibration, session, correction, revisions, steps, temperatures)


def correction_document(storage: Storage, id: str) -> Json:
    """imu-correction/1; NotFoundError where the session's programme gives none."""
    result = corrected(storage, id)
    curves, blocks, moved = result.calibration.thermal, result.found.blocks, result.found.blocks
    if curves is not None and result.session.temperature is not None:
        first_row = at_temperature(result.calibration, float(result.session.temperature[0]))
        moved = correction_of(result.session, first_row).blocks
    return {
        **_identity(result.stored, result.calibration),
        **_temperatures(curves),
        "formula": [*(OVER_TEMPERATURE if curves else ()), *FORMULA],
        "blocks": [_block(block, at, result.session, curves) for block, at in zip(blocks, moved, strict=True)],
        "left_out": [{"sensor": name, "why": why} for name, why in result.found.left_out],
        "not_corrected": [
            ALWAYS_LEFT[0],
            BEYOND_RANGE if curves else ONE_TEMPERATURE,
            *ALWAYS_LEFT[1:],
            *(_assumed(block) for block in blocks if _assumed(block)),
        ],
        "extended_model": [_revision(revision) for revision in result.revisions],
        "temperature_laws": [_law(*place, step) for place, step in result.steps.items()],
        "temperatures_covered": None if result.temperatures is None else vars(result.temperatures),
    }


def _reasons(correction: Correction) -> Iterator[str]:
    yield from (f"{name}: {why}" for name, why in correction.left_out)


def _identity(stored: StoredSession, calibration: Calibration) -> Json:
    return {
        "format": "imu-correction/1",
        "unit": stored.unit,
        "session": stored.id,
        "sha256": stored.sha256,
        "measured_at": stored.started_at.isoformat(),
        "verdict": stored.verdict.value,
        "simulated": stored.simulated,
        "method": calibration.method,
        "model_revision": stored.revision,
        "frame": f"block axes, held by {calibration.gauge}",
        "software": f"imu-health {VERSION}",
    }


def _temperatures(curves: ThermalCurves | None) -> Json:
    if curves is None:
        return {}
    ends = [curves.lowest, curves.highest]
    return {"reference_temperature_c": curves.reference_temperature, "temperature_range_c": ends}


def _over_temperature(sensor: SensorCorrection, curves: ThermalCurves | None) -> Json:
    """Coefficients in rising powers of dT."""
    fitted = None if curves is None else next((c for c in curves.sensors if c.name == sensor.name), None)
    if fitted is None:
        return {}
    curved = {"scale_over_temperature": fitted.scale, "bias_over_temperature": fitted.bias}
    return {name: c.coefficients[: c.order + 1].tolist() for name, c in curved.items() if c is not None}


def _block(
    block: BlockCorrection, at_first: BlockCorrection, session: CalibrationSession, curves: ThermalCurves | None
) -> Json:
    """``at_first``: the same block at the temperature of the first row."""
    unit = _unit(block)
    return {
        "kind": block.kind,
        "gives": f"{'specific force' if block.kind == ACCELEROMETER else 'angular rate'}, {unit}, block axes",
        "sensors": [_sensor(sensor, unit) | _over_temperature(sensor, curves) for sensor in block.sensors],
        "matrix": block.matrix.tolist(),
        "example": _example(at_first, session),
    }


def _unit(block: BlockCorrection) -> str:
    return "m/s²" if block.kind == ACCELEROMETER else "rad/s"


def _sensor(sensor: SensorCorrection, unit: str) -> Json:
    per = "rad" if sensor.count_time else unit
    return {
        "name": sensor.name,
        "reading_unit": sensor.reading_unit,
        "offset": sensor.offset,
        "count_time": sensor.count_time,
        "scale": sensor.scale,
        "bias": sensor.bias,
        "quadratic": sensor.quadratic,
        "axis": sensor.axis.tolist(),
        "units": {
            "offset": sensor.reading_unit,
            "count_time": "s",
            "scale": f"{sensor.reading_unit} per {per}",
            "bias": unit,
            "quadratic": f"1/({unit})",
        },
    }


def _example(block: BlockCorrection, session: CalibrationSession) -> Json:
    """The first row of the session, corrected step by step."""
    names = [sensor.name for sensor in session.sensors]
    readings = session.readings[0, [names.index(sensor.name) for sensor in block.sensors]]
    y = np.array([s.input(readings[i]) for i, s in enumerate(block.sensors)])
    a, vector = block.components(readings), block.vector(readings)
    sigma = np.sqrt(np.diag(block.vector_covariance(readings)))
    applied = stand_geometry(session).n[0, names.index(block.sensors[0].name)] if _on_stand(session) else None
    return {
        "row": 1,
        "readings": readings.tolist(),
        "y": y.tolist(),
        "a": a.tolist(),
        "vector": vector.tolist(),
        "expanded_uncertainty": json_numbers(COVERAGE * sigma),
        "coverage_factor": COVERAGE,
        "applied": None if applied is None else applied.tolist(),
        "words": [
            *_first_steps(block.sensors[0], readings[0], y[0], a[0]),
            *_last_steps(block, session, vector, applied),
        ],
    }


def _on_stand(session: CalibrationSession) -> bool:
    return session.programme == TWO_AXIS_STAND


def _first_steps(sensor: SensorCorrection, reading: float, y: float, a: float) -> Iterator[str]:
    divisor = f"({_n(sensor.count_time)} * {_n(sensor.scale)})" if sensor.count_time else _n(sensor.scale)
    yield (
        f"{sensor.name} read {_n(reading)} {sensor.reading_unit}: "
        f"y = ({_n(reading)} - {_n(sensor.offset)}) / {divisor} - ({_n(sensor.bias)}) = {_n(y)}."
    )
    yield f"a = 2 * {_n(y)} / (1 + sqrt(1 + 4 * ({_n(sensor.quadratic)}) * {_n(y)})) = {_n(a)}."


def _last_steps(
    block: BlockCorrection, session: CalibrationSession, vector: Array, applied: Array | None
) -> Iterator[str]:
    unit = _unit(block)
    yield f"With all {len(block.sensors)} sensors, matrix * a = ({_listed(vector)}) {unit}."
    if applied is not None:
        yield f"The stand applied ({_listed(applied)}) {unit}."
    length, reference = float(np.linalg.norm(vector)), magnitude(session, block.kind)
    yield f"Its length is {_n(length)} {unit}; that of the reference is {_n(reference)}."


def _n(value: float) -> str:
    return f"{value:.{DIGITS}g}"


def _listed(vector: Array) -> str:
    return ", ".join(_n(float(x)) for x in vector)


def _assumed(block: BlockCorrection) -> str:
    names = [sensor.name for sensor in block.sensors if not sensor.quadratic_known]
    return f"quadratic term of {', '.join(names)}: not observed by this session, taken as zero" if names else ""


def _revision(revision: ModelRevision) -> Json:
    """An accepted cause: the parameters were estimated with it in the model, the formula does not contain it."""
    evidence = evidence_to_dict(revision.evidence)
    return {
        "revision": revision.id,
        "cause": revision.cause,
        "sensors": list(revision.sensors),
        **{name: evidence.get(name) for name in ("amplitude", "sigma", "units")},
        "note": "taken out of the readings before the parameters were estimated; the formula does not correct it",
    }


def _law(sensor: str, parameter: str, step: TemperatureStep) -> Json:
    """The effect of the session's temperature on a parameter, which the formula does not remove."""
    return {
        "sensor": sensor,
        "parameter": parameter,
        "temperature_c": step.temperature,
        "reference_temperature_c": step.reference_temperature,
        "worth": step.worth,
        "sigma": step.sigma,
        "unit": "relative" if parameter == "scale" else "SI",
        "sessions": step.sessions,
        "lowest_c": step.lowest,
        "highest_c": step.highest,
        "units": step.units,
    }
