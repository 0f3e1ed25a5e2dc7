"""Arbitrary orientations by maximum likelihood: any three or more accelerometers, gravity of known size.

The block is set down, still, in orientations that nobody needs to know. Each orientation is two unknowns of its own
(`model`), the sensors' parameters are found by Levenberg–Marquardt with the orientations eliminated (`solve`) from a
linear start (`start`); what the set does not tell is said (`information`). Directions that the session states to a
known sigma enter as a prior, which is what makes six labelled positions enough.

The quadratic term. ``quadratic`` True: estimated. False: left out of the model, reported as not observable. None:
estimated when the set determines every parameter with it and keeps degrees of freedom, and either every sensor's c·g to
better than 1e-4 or terms that are plainly there (likelihood ratio, at 1e-3; `optional`). On measured recordings terms
that pass neither predict held-out positions worse than none, and those that pass predict them better
(docs/recordings.md).
Source: multi-parameter optimisation paper, functional (5), in its maximum-likelihood form.
"""

from dataclasses import replace

import numpy as np

from estimator.applied_vector import gravity
from estimator.calibration.free.by_hand import HandGyros, gyros_by_hand, with_cross
from estimator.calibration.free.excess import explained
from estimator.calibration.free.gyros import GyroBiases, rest_biases
from estimator.calibration.free.knowledge import merged, of_accelerometers, of_gyros, of_nothing
from estimator.calibration.free.model import WEIGHTLESS, ModelRows, jacobian, predicted
from estimator.calibration.free.optional import agreed, solve
from estimator.calibration.free.report import fit_of_accelerometers, fit_of_gyros, report
from estimator.calibration.free.schedule import Mask, check, classified
from estimator.calibration.free.start import start
from estimator.errors import ScheduleError
from estimator.forward import measured
from estimator.parameters import names
from estimator.results import NOMINAL_AXES, Calibration
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, Array, CalibrationSession

__all__ = [
    "accelerometer_rows",
    "agreed",
    "calibrate_free",
    "check",
    "gyro_biases",
    "residual_per_freedom",
    "solve",
    "tilt_response",
]

UNSTATED_NOISE = 1e-4
"""g; noise to begin with where none is stated. Estimated from the residuals afterwards, so only its order counts."""


def calibrate_free(session: CalibrationSession, *, quadratic: bool | None = None) -> Calibration:
    """Calibrate a block from still rows in arbitrary orientations.

    Parameters
    ----------
    session : averaged rows; raw logs go through `estimator.static` first.
    quadratic : see the head of this file.

    Raises
    ------
    ScheduleError
        Rows from which nothing can be estimated. Rows that determine only a part are a result.
    """
    live, dead, gyro = classified(session)
    scale = np.array([s.nominal_scale for s in session.sensors])
    axes = np.stack([s.nominal_axis for s in session.sensors])
    readings = measured(session)[0]
    parts = []
    if dead.any():
        parts.append((np.flatnonzero(dead), of_nothing(readings[:, dead], scale[dead], axes[dead])))
    if gyro.all():
        biases = gyro_biases(session, gyro)
        known = of_gyros(biases, scale, axes)
        return report(session, known, fit_of_gyros(biases, names(session.sensors)), NOMINAL_AXES)
    g = gravity(session.site)
    rows, stated = accelerometer_rows(session, live, g)
    solution = solve(rows, stated, quadratic)
    used = explained(solution) if stated else solution
    known = of_accelerometers(used, solution.rows.sigma, scale[live], g)
    live_names = names(tuple(s for s, is_live in zip(session.sensors, live, strict=True) if is_live))
    fit = fit_of_accelerometers(solution, used, known, stated, live_names)
    gauge = "directions" if rows.held else NOMINAL_AXES
    at, gyros = np.flatnonzero(live), np.flatnonzero(gyro)
    by_hand = gyros_by_hand(session, used, live, gyro)
    if isinstance(by_hand, HandGyros):
        everything = with_cross(merged([(at, known), *parts, (gyros, by_hand.known)]), gyros, at, by_hand.cross)
        answers = dict(zip(gyros.tolist(), by_hand.answers, strict=True))
        return replace(report(session, everything, fit, gauge, answers), hand_turns=by_hand.turns)
    if gyro.any():
        parts.append((gyros, of_gyros(gyro_biases(session, gyro), scale[gyro], axes[gyro])))
    return replace(report(session, merged([(at, known), *parts]), fit, gauge), hand_turns=by_hand)


def residual_per_freedom(session: CalibrationSession) -> float:
    """Root of the squared residuals per degree of freedom, m/s², and one standard error of that on top.

    What the still stretches of a raw log are chosen by; infinite where the rows do not determine everything, and zero,
    so that the first choice stands, for a block of gyros alone.
    """
    live, _, _ = classified(session)
    if not live.any():
        return 0.0
    g = gravity(session.site)
    rows, stated = accelerometer_rows(session, live, g)
    solution = solve(rows, stated, quadratic=False)
    if not solution.knowledge.full or solution.dof < 1:
        return float("inf")
    squares = ((rows.y - predicted(solution.unknowns)) * g / np.exp(solution.unknowns.log_scale)) ** 2
    squares = np.where(rows.takes_part, squares, 0.0)
    return float(np.sqrt(squares.sum() / solution.dof) * (1 + 1 / np.sqrt(2 * solution.dof)))


def tilt_response(session: CalibrationSession) -> Array | None:
    """(R, m, 2) change of every reading, its unit per rad, with the two tilts of its row, 0 of gyros.

    None of other programmes, where the direction of a row is no unknown of its own, and where nothing can be estimated.
    """
    if session.programme != ARBITRARY_ORIENTATIONS:
        return None
    try:
        live, _, _ = classified(session)
    except ScheduleError:
        return None
    if not live.any():
        return None
    g = gravity(session.site)
    rows, stated = accelerometer_rows(session, live, g)
    scale = np.array([s.nominal_scale for s in session.sensors])
    response = np.zeros((*session.readings.shape, 2))
    response[:, live] = jacobian(solve(rows, stated, quadratic=False).unknowns)[1] * g * scale[live, None]
    return response


def accelerometer_rows(session: CalibrationSession, chosen: Mask, g: float) -> tuple[ModelRows, bool]:
    """Dimensionless rows of the accelerometers, and whether their noise is stated; readings that take no part have an
    infinite one."""
    sensors = [s for s, is_chosen in zip(session.sensors, chosen, strict=True) if is_chosen]
    readings, errors = measured(session)
    unit = g * np.array([s.nominal_scale for s in sensors])
    axes = np.stack([s.nominal_axis for s in sensors])
    y = readings[:, chosen] / unit
    directions, prior = stated_directions(session)
    repeatability = np.array([s.bias_repeatability for s in sensors]) / g
    rows = ModelRows(y, np.full(y.shape, UNSTATED_NOISE), directions, prior, axes)
    gain = np.exp(start(rows).log_scale) if repeatability.any() else 1.0
    sigma = np.hypot(errors[:, chosen] / np.abs(unit), gain * repeatability)
    out = sigma >= WEIGHTLESS
    usable = ~out & (sigma > 0)
    if np.all(usable | out):
        return rows.weighted(sigma), True
    typical = float(np.median(sigma[usable])) if usable.any() else UNSTATED_NOISE
    return rows.weighted(np.where(usable | out, sigma, typical)), False


def stated_directions(session: CalibrationSession) -> tuple[Array, Array]:
    """Directions (R, 3), unit vectors, zeros where unknown, and their inverse variance (R,), rad⁻², 0 where unknown.

    Directions along one line leave the turn about it open: they are then not used, and the nominal axes hold the frame.
    """
    R = len(session.readings)
    if session.directions is None or not session.direction_sigma:
        return np.zeros((R, 3)), np.zeros(R)
    stated = np.asarray(np.isfinite(session.directions).all(axis=1))
    directions = np.where(stated[:, None], session.directions, 0.0)
    if np.linalg.svd(directions, compute_uv=False)[1] < 0.1:
        return np.zeros((R, 3)), np.zeros(R)
    tilt = 0.0 if session.tilt_error is None else session.tilt_error
    return directions, stated / (session.direction_sigma**2 + tilt**2)


def gyro_biases(session: CalibrationSession, chosen: Mask) -> GyroBiases:
    """The gyros' biases by their nominal scale."""
    sensors = [s for s in session.sensors if s.kind != ACCELEROMETER]
    readings, errors = measured(session)
    scale = np.array([s.nominal_scale for s in sensors])
    repeatability = np.array([s.bias_repeatability for s in sensors])
    return rest_biases(readings[:, chosen] / scale, errors[:, chosen] / np.abs(scale), repeatability)
