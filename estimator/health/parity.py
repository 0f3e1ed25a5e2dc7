"""A recording judged by what parity shows, sensor by sensor.

Nothing detected: a parameter passes when a change of the size of its tolerance would have been detected with 95 %
power; otherwise it is undecidable, because it could not have been seen. A change detected: the candidates are judged by
the four-state rule on the change that each would need; the others as if nothing were detected, unless the candidates
do not explain the finding or name several sensors: then nobody passes.
"""

from collections.abc import Mapping

import numpy as np
from scipy.special import ndtr
from scipy.stats import ncx2

from estimator.health.decision import Judgement
from estimator.health.rule import PASS, UNDECIDABLE, state
from estimator.parity.results import SEVERAL, ParityResult, SensorParity, Sight
from estimator.results import Calibration

RULE = "parity/1"
PARAMETERS = ("scale", "bias", "axis")


def judge_parity(
    result: ParityResult,
    reference: Calibration,
    tolerances: Mapping[tuple[str, str], float],
    *,
    coverage_factor: float = 2.0,
) -> tuple[Judgement, ...]:
    """Judge scale, bias and axis of every sensor that parity sees and that has a tolerance.

    Parameters
    ----------
    result : of the recording.
    reference : the calibration that it was compared with.
    tolerances : T by (kind of sensor, parameter): relative for scale, else SI.
    coverage_factor : k.
    """
    return tuple(
        judged(result, sensor, parameter, reference, tolerances[result.kind, parameter], coverage_factor)
        for sensor in result.sensors
        for parameter in PARAMETERS
        if (result.kind, parameter) in tolerances
    )


def judged(
    result: ParityResult, sensor: SensorParity, parameter: str, reference: Calibration, tolerance: float, k: float
) -> Judgement:
    """One parameter of one sensor."""
    sight: Sight = getattr(sensor, parameter)
    origin = None if parameter == "axis" else getattr(reference.sensor(sensor.name), parameter).value
    size, sigma = sight.size, sight.sigma
    value = size
    if size is not None and origin is not None:
        value = origin + size * (abs(origin) if parameter == "scale" else 1.0)
    return Judgement(
        sensor=sensor.name,
        kind=result.kind,
        parameter=parameter,
        value=value,
        reference=0.0 if parameter == "axis" else origin,
        deviation=size,
        uncertainty=sigma,
        expanded=None if sigma is None else k * sigma,
        tolerance=tolerance,
        probability_out=probability_out(sight, tolerance),
        critical=sight.detectable,
        verdict=verdict(result, sensor.name, parameter, sight, tolerance, k),
    )


def verdict(result: ParityResult, sensor: str, parameter: str, sight: Sight, tolerance: float, k: float) -> str:
    """The state, as the head of this file says."""
    if sight.size is None or sight.sigma is None or sight.detectable is None:
        return UNDECIDABLE
    found = [c for c in result.candidates if c.sensor == sensor and c.kind in (parameter, SEVERAL)]
    if found:
        own = state(abs(sight.size), k * sight.sigma, tolerance, 0.0)
        return own if result.isolated or own != PASS else UNDECIDABLE
    settled = not result.detected or (result.isolated is not None and result.explained)
    return PASS if settled and sight.detectable <= tolerance else UNDECIDABLE


def probability_out(sight: Sight, tolerance: float) -> float | None:
    """Probability that the change is beyond the tolerance, if only this has changed."""
    if sight.change is None or sight.size is None or sight.sigma is None:
        return None
    if len(sight.change) == 1:
        return float(ndtr((sight.size - tolerance) / sight.sigma) + ndtr((-sight.size - tolerance) / sight.sigma))
    variance = sight.sigma**2 / 2
    return float(ncx2.sf(tolerance**2 / variance, 2, np.square(sight.size) / variance))
