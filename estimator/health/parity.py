"""Judges a recording, sensor by sensor, by its parity residuals.

Nothing detected: a parameter passes when a change of the size of its tolerance would have been detected with 95 %
power; otherwise it is undecidable, because it could not have been seen. A change detected: the candidates are judged by
the four-state rule on the change that each would need; the others as if nothing were detected, unless the candidates
do not explain the finding or name several sensors: then nobody passes.

A sensor that fails within the recording is out of tolerance in every parameter, whatever it was before, and by how much
is not known; where several could be the one, all of them. The others are judged by the part before.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.special import chndtr, ndtr

from estimator.health.decision import ParameterJudgement
from estimator.health.rule import FAIL, PASS, UNDECIDABLE, state, tolerance_of
from estimator.parity.as_calibration import before_faults
from estimator.parity.results import SEVERAL, ParityResult, SensorParity, Sight
from estimator.results import Calibration

RULE = "parity/2"
PARAMETERS = ("scale", "bias", "axis")
"""The parameters in the order in which they are judged; parity cannot see the second-order term."""

NOT_KNOWN = dict.fromkeys(("deviation", "uncertainty", "expanded", "probability_out", "critical"))
FAILED: Mapping[str, Any] = {**NOT_KNOWN, "verdict": FAIL}
"""Verdict on every parameter of a sensor that fails."""


def judge_parity(
    result: ParityResult,
    reference: Calibration,
    tolerances: Mapping[tuple[str, str], float],
    *,
    coverage_factor: float = 2.0,
) -> tuple[ParameterJudgement, ...]:
    """Judge scale, bias and axis of every sensor that parity sees and that has a tolerance.

    Parameters
    ----------
    result : of the recording.
    reference : the calibration that it was compared with.
    tolerances : T by (kind of sensor, parameter), or by (sensor, parameter) where a sensor has its own: relative for
        scale, else SI.
    coverage_factor : k.
    """
    known = before_faults(result)
    judged = (
        _judged(_ParityCase(known, sensor, parameter, tolerance), reference, coverage_factor)
        for sensor in known.sensors
        for parameter in PARAMETERS
        if (tolerance := tolerance_of(tolerances, sensor.name, result.kind, parameter)) is not None
    )
    at_fault = {name for fault in result.faults for name in fault.suspects}
    return tuple(replace(j, **FAILED) if j.sensor in at_fault else j for j in judged)


@dataclass(frozen=True)
class _ParityCase:
    """One parameter of one sensor that is to be judged."""

    result: ParityResult
    sensor: SensorParity
    parameter: str
    tolerance: float

    @property
    def sight(self) -> Sight:
        """Sight of this parameter in the recording."""
        sight: Sight = getattr(self.sensor, self.parameter)
        return sight

    @property
    def is_candidate(self) -> bool:
        """Whether a change of this parameter would explain the detection."""
        return any(c.sensor == self.sensor.name and c.kind in (self.parameter, SEVERAL) for c in self.result.candidates)


def _judged(case: _ParityCase, reference: Calibration, k: float) -> ParameterJudgement:
    """The case with its verdict; the measured value is the reference's, moved by the change."""
    sight, name, parameter = case.sight, case.sensor.name, case.parameter
    origin = None if parameter == "axis" else getattr(reference.sensor(name), parameter).value
    size, sigma = sight.size, sight.sigma
    value = size
    if size is not None and origin is not None:
        value = origin + size * (abs(origin) if parameter == "scale" else 1.0)
    return ParameterJudgement(
        sensor=name,
        kind=case.result.kind,
        parameter=parameter,
        value=value,
        reference=0.0 if parameter == "axis" else origin,
        deviation=size,
        uncertainty=sigma,
        expanded=None if sigma is None else k * sigma,
        tolerance=case.tolerance,
        probability_out=probability_out(sight, case.tolerance),
        critical=sight.detectable,
        verdict=_verdict(case, k),
        coverage_factor=k,
    )


def _verdict(case: _ParityCase, k: float) -> str:
    """The state, as the head of this file says."""
    result, sight, tolerance = case.result, case.sight, case.tolerance
    if sight.size is None or sight.sigma is None or sight.detectable is None:
        return UNDECIDABLE
    if case.is_candidate:
        verdict = state(abs(sight.size), k * sight.sigma, tolerance, 0.0)
        return verdict if result.isolated or verdict != PASS else UNDECIDABLE
    is_settled = not result.detected or result.isolated is not None
    return PASS if is_settled and sight.detectable <= tolerance else UNDECIDABLE


def probability_out(sight: Sight, tolerance: float) -> float | None:
    """Probability that the change is beyond the tolerance, if only this has changed."""
    if sight.change is None or sight.size is None or sight.sigma is None:
        return None
    if len(sight.change) == 1:
        return float(ndtr((sight.size - tolerance) / sight.sigma) + ndtr((-sight.size - tolerance) / sight.sigma))
    variance = sight.sigma**2 / 2
    return float(1 - chndtr(tolerance**2 / variance, 2, np.square(sight.size) / variance))
