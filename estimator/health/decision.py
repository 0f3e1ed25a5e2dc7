"""A session judged against the unit's reference session: every parameter of every sensor. The rule: see `rule`.

What all sensors did together (`common_motion`) is taken off first: a sensor is judged on what is left.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr

from estimator.health.common_motion import AXES, CommonMotion, Split, common_motion
from estimator.health.deviation import NOT_SEEN, Deviation, axis_offset, deviation
from estimator.health.disc import judge_length
from estimator.health.rule import SESSION_LEVEL, UNDECIDABLE, critical_factors, state
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import Array

PARAMETERS = ("scale", "bias", "quadratic", "axis", "misalignment")
FLOOR = 1e-9
"""Standard uncertainties below this part of the tolerance are taken as this part of it."""


@dataclass(frozen=True)
class Judgement:
    """One parameter of one sensor, judged; SI, see the package page. What is not known is None."""

    sensor: str
    kind: str
    parameter: str
    value: float | None
    """The measured parameter; for the axis the measured angle from the reference axis, rad."""
    reference: float | None
    """The reference's value; 0 for the axis."""
    deviation: float | None
    """y: relative for scale; for the axis the angle freed of the upward pull of noise."""
    uncertainty: float | None
    """u, of both sessions."""
    expanded: float | None
    """U = k·u, which is also the guard band."""
    tolerance: float
    probability_out: float | None
    """Probability that the true deviation is out of tolerance."""
    critical: float | None
    """Smallest |y| that counts as a change at the level of the session."""
    verdict: str
    change: tuple[float, ...] | None = None
    """What was judged, with its sign and direction: one number, for the axis two along the reference's tangents."""
    change_own: tuple[float, ...] | None = None
    """Standard uncertainty of each number of the change that this session brings."""
    change_origin: tuple[float, ...] | None = None
    """The same of the reference, common to all sessions that are judged against it."""
    common: float | None = None
    """What all sensors did together, taken off before: angle of the block's turn for the axis, factor for scale."""
    common_sigma: float | None = None
    """One sigma of it."""
    common_p: float | None = None
    """Chance of a common change as large when nothing moved together."""


@dataclass(frozen=True)
class _Assessed:
    """A deviation in the numbers that the rule needs."""

    change: Deviation
    y: float
    u: float
    probability_out: float
    critical_scale: float
    """What a factor of `critical_factors` is multiplied by to become a deviation."""
    is_vector: bool


def judge(
    calibration: Calibration,
    reference: Calibration | None,
    tolerances: Mapping[tuple[str, str], float],
    *,
    coverage_factor: float = 2.0,
    level: float = SESSION_LEVEL,
    splits: tuple[Split, ...] | None = None,
) -> tuple[Judgement, ...]:
    """Judge every parameter that has a tolerance, sensor after sensor.

    Parameters
    ----------
    calibration : what the session found.
    reference : what it is compared with; None when the session itself becomes the reference.
    tolerances : T by (kind of sensor, parameter): relative for scale, else SI. A parameter without one is not judged.
    coverage_factor : k.
    level : α, chance that a unit exactly at its reference is called out of tolerance in this session.
    splits : of `common_motion` over the two calibrations; found here when None.
    """
    if splits is None:
        splits = () if reference is None else common_motion(calibration, reference, tolerances)
    parts = {(s.motion.kind, "axis" if s.motion.quantity == AXES else "scale"): s for s in splits if s.left}
    origins = {sensor.name: sensor for sensor in (reference or calibration).sensors}
    cases = [
        (sensor, origins.get(sensor.name), parameter, tolerances[sensor.kind, parameter])
        for sensor in calibration.sensors
        for parameter in PARAMETERS
        if parameter in sensor.observable and (sensor.kind, parameter) in tolerances
    ]
    assessed = [None if reference is None else _assess(*case, coverage_factor, parts) for case in cases]
    judged = sum(a is not None and coverage_factor * a.u <= case[3] for a, case in zip(assessed, cases, strict=True))
    factors = critical_factors(judged, _noise_dof(calibration, reference), level)
    return tuple(
        _judgement(*case, a, coverage_factor, factors, parts.get((case[0].kind, case[2])))
        for case, a in zip(cases, assessed, strict=True)
    )


def _noise_dof(calibration: Calibration, reference: Calibration | None) -> float:
    """Degrees of freedom of the worse known noise; infinite when both files state theirs."""
    fits = [c.fit for c in (calibration, reference) if c is not None]
    return min([max(fit.dof, 1) for fit in fits if fit.noise == "estimated"], default=np.inf)


def _assess(
    sensor: SensorCalibration,
    origin: SensorCalibration | None,
    parameter: str,
    tolerance: float,
    k: float,
    parts: Mapping[tuple[str, str], Split],
) -> _Assessed | None:
    change = None if origin is None or origin.kind != sensor.kind else deviation(sensor, origin, parameter)
    if change is not None and (sensor.kind, parameter) in parts:
        change = parts[sensor.kind, parameter].left.get(sensor.name, change)
    if change is None or not (np.isfinite(change.vector).all() and np.isfinite(change.covariance).all()):
        return None
    return _assess_scalar(change, tolerance) if change.vector.size == 1 else _assess_axis(change, tolerance, k)


def _assess_scalar(change: Deviation, tolerance: float) -> _Assessed:
    y = float(change.vector[0])
    u = max(float(np.sqrt(change.covariance[0, 0])), FLOOR * tolerance)
    out = float(ndtr((y - tolerance) / u) + ndtr((-y - tolerance) / u))
    return _Assessed(change, y, u, out, u, is_vector=False)


def _assess_axis(change: Deviation, tolerance: float, k: float) -> _Assessed:
    covariance = change.covariance + (FLOOR * tolerance) ** 2 * np.eye(2)
    length = judge_length(change.vector, covariance, tolerance, k)
    mahalanobis = float(np.sqrt(change.vector @ np.linalg.solve(covariance, change.vector)))
    largest = float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))
    scale = length.value / mahalanobis if length.value > 0 else largest
    return _Assessed(change, length.value, length.expanded / k, length.probability_beyond, scale, is_vector=True)


def _judgement(
    sensor: SensorCalibration,
    origin: SensorCalibration | None,
    parameter: str,
    tolerance: float,
    found: _Assessed | None,
    k: float,
    factors: tuple[float, float],
    part: Split | None,
) -> Judgement:
    value, reference = _values(sensor, origin, parameter)
    critical = None if found is None else factors[found.is_vector] * found.critical_scale
    verdict = UNDECIDABLE
    if found is not None and critical is not None:
        verdict = state(abs(found.y), k * found.u, tolerance, critical)
    motion = None if found is None else _motion_of(part, sensor.name)
    return Judgement(
        sensor=sensor.name,
        kind=sensor.kind,
        parameter=parameter,
        value=value,
        reference=reference,
        deviation=None if found is None else found.y,
        uncertainty=None if found is None else found.u,
        expanded=None if found is None else k * found.u,
        tolerance=tolerance,
        probability_out=None if found is None else found.probability_out,
        critical=critical,
        verdict=verdict,
        change=None if found is None else tuple(map(float, found.change.vector)),
        change_own=None if found is None else _sigmas(found.change.own),
        change_origin=None if found is None else _sigmas(found.change.origin),
        common=None if motion is None else motion.size,
        common_sigma=None if motion is None else motion.sigma,
        common_p=None if motion is None else motion.p_value,
    )


def _motion_of(part: Split | None, sensor: str) -> CommonMotion | None:
    """The common part that was taken off this sensor's change."""
    return None if part is None or sensor not in part.left else part.motion


def _sigmas(covariance: Array) -> tuple[float, ...]:
    return tuple(float(np.sqrt(max(variance, 0.0))) for variance in np.diagonal(covariance))


def _value(sensor: SensorCalibration, parameter: str) -> float | None:
    estimate: Estimate = getattr(sensor, parameter) or NOT_SEEN
    return estimate.value


def _values(
    sensor: SensorCalibration, origin: SensorCalibration | None, parameter: str
) -> tuple[float | None, float | None]:
    """Measured and reference value; a session that becomes the reference is its own origin."""
    if parameter != "axis":
        return _value(sensor, parameter), None if origin is None else _value(origin, parameter)
    if sensor.axis is None or origin is None or origin.axis is None:
        return None, None
    return float(np.hypot(*axis_offset(sensor.axis, origin.axis, origin.axis_tangents))), 0.0
