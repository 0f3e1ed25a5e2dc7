"""The model extended with what was found: amplitudes, and the calibration with the effects taken out.

Theory
------
With the baseline's normal matrix and a signature X, block inversion gives for the parameters the covariance
C + L·V·L', where V = (X'PX)⁻¹ is the amplitudes' covariance and L the parameters' answer to X. So the extended
calibration is the ordinary one of the readings with the effect taken out, its covariance enlarged by L·V·L'.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from estimator.calibration.calibrate import calibrate
from estimator.diagnosis.selection.search_state import Excess, Search
from estimator.diagnosis.signatures.autocorrelation import Serial
from estimator.diagnosis.signatures.scores import INVISIBLE, Scored
from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import ACCELEROMETER, Array, CalibrationSession


@dataclass(frozen=True, eq=False)
class Amplitudes:
    """Joint estimate of all findings' amplitudes, finding after finding. f amplitudes."""

    value: Array
    """(f,)"""
    covariance: Array
    """(f, f)"""
    slices: tuple[slice, ...]


def amplitudes(state: Search) -> Amplitudes:
    """Least squares of the left-over on the traces of all findings together."""
    found = [f.best for f in state.found]
    widths = np.cumsum([0, *(s.columns.shape[1] for s in found)])
    slices = tuple(slice(int(a), int(b)) for a, b in pairwise(widths))
    if not found:
        return Amplitudes(np.zeros(0), np.zeros((0, 0)), slices)
    columns = np.concatenate([s.columns for s in found], axis=1)
    z = state.evidence.z
    if state.structures:
        pattern = np.concatenate([s.best.columns for s in state.structures], axis=1)
        left, size, _ = np.linalg.svd(pattern, full_matrices=False)
        left = left[:, size > 1e-9 * size[0]]
        z = z - left @ (left.T @ z)
    white = [np.linalg.norm(state.evidence.raw(s.shape.columns), axis=0) for s in found]
    raw = np.concatenate(white)
    shown = np.maximum(np.linalg.norm(columns, axis=0), INVISIBLE * raw)
    scale = np.where(shown > 0, shown, 1.0)
    gram = (columns / scale).T @ (columns / scale)
    covariance = np.linalg.inv(gram + 1e-12 * np.eye(len(gram))) / scale[:, None] / scale
    covariance *= np.outer(shown > 0, shown > 0)
    return Amplitudes(covariance @ (columns.T @ z), covariance, slices)


def effect(found: Sequence[Scored], fitted: Amplitudes) -> Array:
    """(R, m) what the findings add at the input."""
    return np.sum([s.shape.columns @ fitted.value[part] for s, part in zip(found, fitted.slices, strict=True)], axis=0)


def without_effects(state: Search, fitted: Amplitudes) -> CalibrationSession:
    """The session with the named effects taken out of the readings and the true noise stated.

    A sensor's drift stays in: its parameters really are what they are now.
    """
    session, p = state.baseline.session, state.baseline.parameters
    taken = [f.best for f in state.found]
    stays = [s.cause.moves_parameters for s in taken]
    readings = session.readings
    if not all(stays):
        inside = [
            s.shape.columns @ fitted.value[part]
            for s, part, stay in zip(taken, fitted.slices, stays, strict=True)
            if not stay
        ]
        pulsed = np.array([s.kind != ACCELEROMETER for s in session.sensors])
        period = np.where(pulsed, session.count_time or 1.0, 1.0)
        readings = readings - np.sum(inside, axis=0) * p.scale * period
    return replace(session, readings=readings, standard_errors=true_errors(state, state.scatter))


def true_errors(state: Search, excess: Sequence[Excess | Serial]) -> Array:
    """(R, m) standard errors with the excess noise in them, reading units."""
    session, scale = state.baseline.session, state.baseline.parameters.scale
    errors = session.standard_errors.copy()
    for noisy in excess:
        i = noisy.sensor
        repeated = (scale[i] * session.sensors[i].bias_repeatability) ** 2
        errors[:, i] = np.sqrt(noisy.ratio * (errors[:, i] ** 2 + repeated) - repeated)
    return errors


def extended_calibration(state: Search, fitted: Amplitudes) -> Calibration:
    """The calibration under the extended model, its covariance enlarged by the amplitudes' own."""
    plain = calibrate(without_effects(state, fitted))
    taken = [f.best for f in state.found]
    if not taken:
        return plain
    keep = [not s.cause.moves_parameters for s in taken]
    columns = np.concatenate([s.shape.columns * k for s, k in zip(taken, keep, strict=True)], axis=-1)
    answer = state.evidence.absorb @ state.evidence.raw(columns)
    factors = state.baseline.parameters.si_factors(state.baseline.setting.norm)
    answer = answer * factors[:, None]
    return enlarged(plain, answer @ fitted.covariance @ answer.T)


def enlarged(calibration: Calibration, more: Array) -> Calibration:
    """The calibration with ``more`` (P, P) added to both covariances."""
    total = calibration.covariance + more
    steady = calibration.repeatability + more
    return replace(
        calibration,
        covariance=total,
        repeatability=steady,
        sensors=tuple(with_sigmas(s, i, total, steady) for i, s in enumerate(calibration.sensors)),
    )


def with_sigmas(sensor: SensorCalibration, i: int, total: Array, steady: Array) -> SensorCalibration:
    """One sensor's estimates with the sigmas of new covariances."""

    def estimate(old: Estimate, element: int) -> Estimate:
        if old.value is None:
            return old
        k = 5 * i + element
        return Estimate(old.value, float(np.sqrt(total[k, k])), float(np.sqrt(steady[k, k])))

    angles = slice(5 * i + 3, 5 * i + 5)
    return replace(
        sensor,
        scale=estimate(sensor.scale, 0),
        bias=estimate(sensor.bias, 1),
        quadratic=estimate(sensor.quadratic, 2),
        axis_covariance=total[angles, angles],
    )
