"""Judges every parameter of every sensor of a session against the unit's reference session, by the rule of `rule`.

The effect of temperature by the unit's law (`temperature_law`), then the change that all sensors share
(`common_motion`), are taken off first: a sensor is judged on its residual.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from estimator.coverage import chance
from estimator.coverage import coverage_factor as factor_of
from estimator.health.common_motion import AXES, CommonMotion, Split, common_motion
from estimator.health.deviation import NOT_SEEN, Deviation, axis_offset, deviation
from estimator.health.disc import judge_length
from estimator.health.rule import SESSION_LEVEL, UNDECIDABLE, critical_factors, state, tolerance_of
from estimator.health.temperature_law import NO_STEPS, Steps, TemperatureCorrection, at_reference, corrections
from estimator.results import COVERAGE, Calibration, Estimate, SensorCalibration
from estimator.session import Array

PARAMETERS = ("scale", "bias", "quadratic", "axis", "misalignment")
"""The parameters in the order in which they are judged."""
FLOOR = 1e-9
"""Standard uncertainties below this part of the tolerance are taken as this part of it: without noise the rule would
divide by zero."""


@dataclass(frozen=True)
class ParameterJudgement:
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
    """U = k·u, which is also the guard band; k by Student's t where the noise is known to few degrees of freedom."""
    tolerance: float
    probability_out: float | None
    """Probability that the true deviation is out of tolerance."""
    critical: float | None
    """Smallest |y| that counts as a change at the level of the session."""
    verdict: str
    change: tuple[float, ...] | None = None
    """The change that was judged, signed: one number, or for the axis two along the reference's tangents."""
    change_own: tuple[float, ...] | None = None
    """Standard uncertainty of each number of the change that this session brings."""
    change_origin: tuple[float, ...] | None = None
    """The reference's contribution in the same form, common to all sessions that are judged against it."""
    common: float | None = None
    """The change shared by all sensors, taken off before: angle of the block's turn for the axis, factor for scale."""
    common_sigma: float | None = None
    """One sigma of the common change."""
    common_p: float | None = None
    """Chance of a common change as large when nothing moved together."""
    coverage_factor: float = COVERAGE
    """k."""
    dof: float | None = None
    """Effective degrees of freedom of u; None when the noise is known."""
    temperature_correction: TemperatureCorrection | None = None
    """The effect of the session's temperature, taken off before judging; None where nothing was."""


@dataclass(frozen=True)
class _Case:
    """One parameter of one sensor that is to be judged."""

    sensor: SensorCalibration
    origin: SensorCalibration | None
    """The sensor in the reference; None where the reference lacks it."""
    parameter: str
    tolerance: float
    split: Split | None
    """The common change of this parameter, where it was separated."""

    @property
    def change(self) -> Deviation | None:
        """The deviation, or its residual beside the common change; None where it is not known."""
        if self.origin is None or self.origin.kind != self.sensor.kind:
            return None
        whole = deviation(self.sensor, self.origin, self.parameter)
        residual = whole if self.split is None else self.split.residuals.get(self.sensor.name, whole)
        return residual if residual is not None and residual.is_finite else None

    @property
    def motion(self) -> CommonMotion | None:
        """The common change that was taken off."""
        return None if self.split is None or self.sensor.name not in self.split.residuals else self.split.motion


@dataclass(frozen=True)
class _Assessed:
    """A deviation in the numbers that the rule needs."""

    change: Deviation
    y: float
    u: float
    k: float
    """Coverage factor for the degrees of freedom of u."""
    probability_out: float
    critical_scale: float
    """Factor that turns a value of `critical_factors` into a deviation."""
    is_vector: bool


def judge(
    calibration: Calibration,
    reference: Calibration | None,
    tolerances: Mapping[tuple[str, str], float],
    *,
    coverage_factor: float = COVERAGE,
    level: float = SESSION_LEVEL,
    splits: tuple[Split, ...] | None = None,
    steps: Steps = NO_STEPS,
) -> tuple[ParameterJudgement, ...]:
    """Judge every parameter that has a tolerance, sensor after sensor.

    Parameters
    ----------
    calibration : what the session found.
    reference : what it is compared with; None when the session itself becomes the reference.
    tolerances : T by (kind of sensor, parameter), or by (sensor, parameter) where a sensor has its own: relative for
        scale, else SI. A parameter without one is not judged.
    coverage_factor : k for known noise; with few degrees of freedom Student's t of the same probability.
    level : α, chance that a unit exactly at its reference is called out of tolerance in this session.
    splits : of `common_motion` over the two calibrations, at one temperature; found here when None.
    steps : what the session's temperature is worth, where a law says it.
    """
    measured = calibration
    if reference is not None:
        calibration = at_reference(measured, reference, steps)
    if splits is None:
        splits = () if reference is None else common_motion(calibration, reference, tolerances)
    parts = {(s.motion.kind, "axis" if s.motion.quantity == AXES else "scale"): s for s in splits if s.residuals}
    origins = {sensor.name: sensor for sensor in (reference or calibration).sensors}
    cases = [
        _Case(sensor, origins.get(sensor.name), parameter, tolerance, parts.get((sensor.kind, parameter)))
        for sensor in calibration.sensors
        for parameter in PARAMETERS
        if parameter in sensor.observable
        and (tolerance := tolerance_of(tolerances, sensor.name, sensor.kind, parameter)) is not None
    ]
    assessed = [None if reference is None else _assess(case, coverage_factor) for case in cases]
    judged = sum(a is not None and a.k * a.u <= case.tolerance for a, case in zip(assessed, cases, strict=True))
    together = (judged, level)
    found = tuple(_judgement(case, a, coverage_factor, together) for case, a in zip(cases, assessed, strict=True))
    if reference is None or not steps:
        return found
    taken = corrections((measured, calibration), reference, steps, coverage_factor)
    return tuple(_as_measured(j, measured, taken.get((j.sensor, j.parameter))) for j in found)


def _as_measured(
    judged: ParameterJudgement, session: Calibration, taken: TemperatureCorrection | None
) -> ParameterJudgement:
    """A judgement at the reference's temperature, with the value as the session measured it."""
    if taken is None:
        return judged
    return replace(judged, value=_value(session.sensor(judged.sensor), judged.parameter), temperature_correction=taken)


def _assess(case: _Case, k: float) -> _Assessed | None:
    """Reduces a case to the numbers of the rule; None where the change is not known."""
    change = case.change
    if change is None:
        return None
    judged = _assess_scalar if change.vector.size == 1 else _assess_axis
    return judged(change, case.tolerance, k)


def _assess_scalar(change: Deviation, tolerance: float, k: float) -> _Assessed:
    """A normal number, or Student's where the noise is known to few degrees of freedom."""
    y, dof = float(change.vector[0]), change.dof
    u = max(float(np.sqrt(change.covariance[0, 0])), FLOOR * tolerance)
    probability = sum(chance((side * y - tolerance) / u, dof) for side in (1, -1))
    return _Assessed(change, y, u, factor_of(k, dof), probability, u, is_vector=False)


def _assess_axis(change: Deviation, tolerance: float, k: float) -> _Assessed:
    """Two normal numbers, judged by their length."""
    covariance = change.covariance + (FLOOR * tolerance) ** 2 * np.eye(2)
    length = judge_length(change.vector, covariance, tolerance, k, change.dof)
    mahalanobis = float(np.sqrt(change.vector @ np.linalg.solve(covariance, change.vector)))
    largest = float(np.sqrt(np.linalg.eigvalsh(covariance)[-1]))
    scale, factor = length.value / mahalanobis if length.value > 0 else largest, factor_of(k, change.dof)
    return _Assessed(
        change, length.value, length.expanded / factor, factor, length.probability_beyond, scale, is_vector=True
    )


def _judgement(case: _Case, assessed: _Assessed | None, k: float, together: tuple[int, float]) -> ParameterJudgement:
    """The case with its verdict; ``together``: how many are judged, and the level of them all."""
    value, reference = _values(case)
    if assessed is None:
        return ParameterJudgement(
            sensor=case.sensor.name,
            kind=case.sensor.kind,
            parameter=case.parameter,
            value=value,
            reference=reference,
            deviation=None,
            uncertainty=None,
            expanded=None,
            tolerance=case.tolerance,
            probability_out=None,
            critical=None,
            verdict=UNDECIDABLE,
            coverage_factor=k,
        )
    (judged, level), dof, motion = together, assessed.change.dof, case.motion
    critical = critical_factors(judged, dof, level)[assessed.is_vector] * assessed.critical_scale
    return ParameterJudgement(
        sensor=case.sensor.name,
        kind=case.sensor.kind,
        parameter=case.parameter,
        value=value,
        reference=reference,
        tolerance=case.tolerance,
        deviation=assessed.y,
        uncertainty=assessed.u,
        expanded=assessed.k * assessed.u,
        probability_out=assessed.probability_out,
        critical=critical,
        verdict=state(abs(assessed.y), assessed.k * assessed.u, case.tolerance, critical),
        change=tuple(map(float, assessed.change.vector)),
        change_own=_sigmas(assessed.change.current),
        change_origin=_sigmas(assessed.change.origin),
        common=None if motion is None else motion.size,
        common_sigma=None if motion is None else motion.sigma,
        common_p=None if motion is None else motion.p_value,
        coverage_factor=assessed.k,
        dof=dof,
    )


def _sigmas(covariance: Array) -> tuple[float, ...]:
    """Standard uncertainty of each number, from a covariance (n, n), SI or relative, squared."""
    return tuple(float(np.sqrt(max(variance, 0.0))) for variance in np.diagonal(covariance))


def _value(sensor: SensorCalibration, parameter: str) -> float | None:
    """The measured value of a scalar parameter; None where it is not known."""
    estimate: Estimate = getattr(sensor, parameter) or NOT_SEEN
    return estimate.value


def _values(case: _Case) -> tuple[float | None, float | None]:
    """Measured and reference value; a session that becomes the reference is its own origin."""
    sensor, origin = case.sensor, case.origin
    if case.parameter != "axis":
        return _value(sensor, case.parameter), None if origin is None else _value(origin, case.parameter)
    if sensor.axis is None or origin is None or origin.axis is None:
        return None, None
    return float(np.hypot(*axis_offset(sensor.axis, origin.axis, origin.axis_tangents))), 0.0
