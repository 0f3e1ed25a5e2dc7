"""The model extended with what was found: amplitudes, and the calibration with the effects taken out.

Theory
------
With the baseline's normal matrix and a signature X, block inversion gives for the parameters the covariance
C + L·V·L', where V = (X'PX)⁻¹ is the amplitudes' covariance and L the parameters' response to X. So the extended
calibration is the ordinary one of the readings with the effect taken out, its covariance enlarged by L·V·L'. A turn of
the block is taken out as the rotation that it is, in the mounting: exp(−k×) turns vectors and axes, and no reading.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from estimator.calibration.calibrate import calibrate
from estimator.diagnosis.posterior.explained import Detection, ExplainedSession
from estimator.diagnosis.residuals.fitted import readings_without
from estimator.diagnosis.residuals.turns import turned_baseline, turned_session
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.least_squares import FAINT, FLAT, least_squares, orthonormal
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.rotations import turn_of
from estimator.session import Array, CalibrationSession

RIDGE = 1e-12
"""Added to the correlation matrix of the traces, so that two equal ones (lasting and new) can be fitted together."""


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """Joint estimate of all findings' amplitudes, finding after finding. f amplitudes, in the causes' SI units."""

    value: Array
    """(f,) SI."""
    covariance: Array
    """(f, f) SI."""
    slices: tuple[slice, ...]
    """Places of each finding's amplitudes."""


def amplitudes(state: ExplainedSession) -> Amplitudes:
    """Least squares of the residuals on the traces of all findings together."""
    detected = [f.best for f in state.detections]
    widths = np.cumsum([0, *(s.trace.shape[1] for s in detected)])
    slices = tuple(slice(int(a), int(b)) for a, b in pairwise(widths))
    if not detected:
        return Amplitudes(np.zeros(0), np.zeros((0, 0)), slices)
    columns = np.concatenate([s.trace for s in detected], axis=1)
    z = state.residuals.z
    if state.structures:
        pattern = np.concatenate([s.best.trace for s in state.structures], axis=1)
        basis = orthonormal(pattern, FLAT)
        z = z - basis @ (basis.T @ z)
    raw = np.concatenate([np.linalg.norm(state.residuals.whitened(s.shape.columns), axis=0) for s in detected])
    shown = np.maximum(np.linalg.norm(columns, axis=0), INVISIBLE * raw)
    scale = np.where(shown > 0, shown, 1.0)
    gram = (columns / scale).T @ (columns / scale)
    covariance = np.linalg.inv(gram + RIDGE * np.eye(len(gram))) / scale[:, None] / scale
    covariance *= np.outer(shown > 0, shown > 0)
    return Amplitudes(covariance @ (columns.T @ z), covariance, slices)


def joint_amplitude(state: ExplainedSession, detection: Detection) -> tuple[Array, Array]:
    """(q,) SI: the amplitudes of one finding given the others; and (n, q) its trace with theirs projected out,
    standard errors per unit amplitude."""
    attributed = state.attributed(without=detection)
    columns = detection.best.trace - attributed @ (attributed.T @ detection.best.trace)
    return least_squares(columns, state.residuals.z, FAINT).value, columns


def without_effects(state: ExplainedSession, fitted: Amplitudes) -> CalibrationSession:
    """The session with the named effects taken out of the readings and the true noise stated.

    A sensor's drift stays in: its parameters really are what they are now. A turn of the block is taken out of the
    mounting.
    """
    session, p = without_turns(state, fitted), state.baseline.parameters
    inside = [
        f.best.shape.columns @ fitted.value[part]
        for f, part in zip(state.detections, fitted.slices, strict=True)
        if not (f.best.cause.moves_parameters or f.best.cause.turns_block or f.best.cause.turns_flipped_run)
    ]
    readings = readings_without(session, p.scale, np.sum(inside, axis=0)) if inside else session.readings
    return replace(session, readings=readings, standard_errors=true_errors(state))


def without_turns(state: ExplainedSession, fitted: Amplitudes) -> CalibrationSession:
    """The session as the block would have been held without its turns, in its mounting and in the flipped run."""
    flips = [f.best.cause.turns_flipped_run for f in state.detections]
    turns = [fitted.value[part] for part, is_flip in zip(fitted.slices, flips, strict=True) if is_flip]
    session = replace(state.baseline.session, flip_turn=turns[0] if turns else np.zeros(3))
    return turned_session(session, turned_back(state, fitted))


def turned_back(state: ExplainedSession, fitted: Amplitudes) -> Array:
    """(3, 3) rotation, dimensionless, from the frame of the session to that of the block before it was turned."""
    turns = [
        fitted.value[part] for f, part in zip(state.detections, fitted.slices, strict=True) if f.best.cause.turns_block
    ]
    return turn_of(-turns[0]) if turns else np.eye(3)


def true_errors(state: ExplainedSession) -> Array:
    """(R, m) standard errors with the excess noise in them, reading units; no claim makes them smaller than stated."""
    session, scale = state.baseline.session, state.baseline.parameters.scale
    larger = np.ones(state.sensor_count)
    for noisy in state.excess:
        larger[noisy.sensor] *= noisy.ratio
    for claim in state.noise_claims:
        larger[list(claim.sensors)] *= max(claim.ratio, 1.0)
    repeated = (scale * np.array([s.bias_repeatability for s in session.sensors])) ** 2
    return np.asarray(np.sqrt(larger * (session.standard_errors**2 + repeated) - repeated))


def extended_calibration(state: ExplainedSession, fitted: Amplitudes) -> Calibration:
    """The calibration under the extended model, its covariance enlarged by the amplitudes' own."""
    plain = calibrate(without_effects(state, fitted))
    if not state.detections:
        return plain
    columns = [f.best.shape.columns * (not f.best.cause.moves_parameters) for f in state.detections]
    baseline = turned_baseline(state.baseline, turned_back(state, fitted))
    residuals = WhitenedResiduals.of(baseline)
    response = residuals.response @ residuals.whitened(np.concatenate(columns, axis=-1))
    factors = state.baseline.parameters.si_factors(state.baseline.setting.norm)
    response = response * factors[:, None]
    more = response @ fitted.covariance @ response.T
    if baseline.unsettled is not None and any(f.event for f in state.detections):
        more += np.diag((baseline.unsettled.ravel() * factors) ** 2)
    return enlarged(plain, more, baseline.parameters.axis_tangents)


def enlarged(calibration: Calibration, more: Array, frames: Array) -> Calibration:
    """The calibration with ``more`` (P, P), SI, added to both covariances; its axes turn along ``frames`` (m, 3, 2),
    dimensionless, which may be others than the calibration's."""
    tangents = np.stack([sensor.axis_tangents for sensor in calibration.sensors])
    carry = np.eye(len(more))
    for i, turn in enumerate(np.swapaxes(tangents, -1, -2) @ frames):
        angles = slice(5 * i + 3, 5 * i + 5)
        carry[angles, angles] = turn
    more = carry @ more @ carry.T
    total = calibration.covariance + more
    steady = calibration.repeatability + more
    return replace(
        calibration,
        covariance=total,
        repeatability=steady,
        sensors=tuple(with_sigmas(s, i, total, steady) for i, s in enumerate(calibration.sensors)),
    )


def with_sigmas(sensor: SensorCalibration, i: int, total: Array, steady: Array) -> SensorCalibration:
    """The i-th sensor's estimates with the sigmas of new covariances ``total`` and ``steady`` (P, P), SI."""

    def estimate(old: Estimate, element: int) -> Estimate:
        if old.value is None or old.sigma is None:
            return old
        k = 5 * i + element
        return replace(old, sigma=float(np.sqrt(total[k, k])), repeatability=float(np.sqrt(steady[k, k])))

    angles = slice(5 * i + 3, 5 * i + 5)
    return replace(
        sensor,
        scale=estimate(sensor.scale, 0),
        bias=estimate(sensor.bias, 1),
        quadratic=estimate(sensor.quadratic, 2),
        axis_covariance=total[angles, angles],
    )
