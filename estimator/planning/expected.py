"""The session that a plan leads to, and what its calibration would say: the same normal equations, no readings."""

from dataclasses import replace

import numpy as np

from estimator.applied_vector import stand_geometry
from estimator.calibration.stand import solved
from estimator.calibration.stand_report import tables
from estimator.forward import response
from estimator.parameters import nominal
from estimator.planning.elevation import conditioning
from estimator.planning.results import Request, Sweep
from estimator.session import ACCELEROMETER, Array, CalibrationSession, Stand


def head_kind(like: CalibrationSession) -> str:
    """The kind of sensor whose elevation is planned: accelerometers (α) where there are any, else gyros (χ)."""
    kinds = {s.kind for s in like.sensors}
    return ACCELEROMETER if ACCELEROMETER in kinds else kinds.pop()


def raised_to(like: CalibrationSession, angle: float) -> Stand:
    """The stand with its head at ``angle``; in a mixed block χ follows α, as the latitude wants."""
    assert like.stand is not None
    stand = like.stand
    if head_kind(like) != ACCELEROMETER:
        return replace(stand, chi=angle)
    if stand.chi is None or stand.alpha is None:
        return replace(stand, alpha=angle)
    return replace(stand, alpha=angle, chi=stand.chi + angle - stand.alpha)


def input_noise(session: CalibrationSession) -> Array:
    """(m,) one sigma of a reading at the input, m/s² (rad/s), with bias repeatability: stated, or from residuals."""
    return np.sqrt(np.median(solved([session]).fitted.variance[0], axis=0))


def planned(
    like: CalibrationSession, angle: float, positions: int, request: Request, sigma: Array
) -> CalibrationSession:
    """The session at N equal steps, read without noise by nominal sensors, its noise stated.

    Parameters
    ----------
    like : gives sensors, stand, site, mounting and count time.
    angle : elevation of the head, rad.
    sigma : (m,) one sigma of a reading at the input, m/s² (rad/s), bias repeatability included.
    """
    runs = request.runs
    beta = np.tile(2 * np.pi * np.arange(positions) / positions, len(runs))
    schedule = replace(
        like,
        stand=raised_to(like, angle),
        beta=beta,
        flipped=np.repeat(np.array(runs), positions),
        time=request.time_per_position * np.arange(len(beta)),
        temperature=None,
        tilt_error=None,
        position=None,
        directions=None,
        direction_sigma=None,
        sample_rate=None,
        counts_averaged=None,
    )
    return read_perfectly(schedule, sigma)


def read_perfectly(schedule: CalibrationSession, sigma: Array) -> CalibrationSession:
    """The schedule with the readings of nominal sensors, unrounded, and the noise as standard errors.

    sigma : (m,) as in `planned`, m/s² (rad/s).
    """
    sensors, p = schedule.sensors, nominal(schedule.sensors)
    pulses = np.array([schedule.count_time is not None and s.kind != ACCELEROMETER for s in sensors])
    period = np.where(pulses, schedule.count_time or 1.0, 1.0)
    variance = sigma**2 - np.array([s.bias_repeatability for s in sensors]) ** 2
    error = np.sqrt(np.maximum(variance * (p.scale * period) ** 2 - np.where(pulses, schedule.quantisation, 0.0), 0.0))
    readings = response(p, stand_geometry(schedule).n) * period + np.array([s.nominal_offset or 0.0 for s in sensors])
    return replace(schedule, readings=readings, standard_errors=np.broadcast_to(error, readings.shape).copy())


def expected_sigmas(session: CalibrationSession) -> tuple[Array, Array]:
    """(m, 4) total and repeatability, one sigma of relative scale, bias, quadratic, axis, SI; NaN if not observed."""
    table = tables(solved([session]))
    scale = np.array([s.nominal_scale for s in session.sensors])

    def four(columns: Array) -> Array:
        """(m, 4) sigmas by parameter from those of the five elements (m, 5), SI, with relative scale and both turns as
        one.
        """
        return np.stack(
            [columns[:, 0] / scale, columns[:, 1], columns[:, 2], np.hypot(columns[:, 3], columns[:, 4])], axis=-1
        )

    return four(table.sigma[0]), four(table.steady[0])


def worst(sigmas: Array) -> Array:
    """(4,) sigmas of the worst sensor, from sigmas (m, 4), SI; NaN where one of them does not observe it."""
    return np.asarray(sigmas.max(axis=0))


def over_positions(like: CalibrationSession, angle: float, numbers: Array, request: Request, sigma: Array) -> Sweep:
    """Expected sigmas over N, ``numbers`` (k,), at one elevation, rad; sigma (m,) as in `planned`, m/s² (rad/s)."""
    return swept([planned(like, angle, int(N), request, sigma) for N in numbers], numbers)


def over_elevation(like: CalibrationSession, angles: Array, positions: int, request: Request, sigma: Array) -> Sweep:
    """Expected sigmas over the elevation, ``angles`` (k,), rad, at one N; sigma (m,) as in `planned`, m/s² (rad/s)."""
    return swept([planned(like, float(a), positions, request, sigma) for a in angles], angles)


def swept(sessions: list[CalibrationSession], at: Array) -> Sweep:
    """The sweep of k planned sessions; ``at`` (k,) elevations in rad, or numbers of positions."""
    pairs = [expected_sigmas(s) for s in sessions]
    return Sweep(
        at=at,
        total=np.stack([worst(total) for total, _ in pairs]),
        repeatability=np.stack([worst(steady) for _, steady in pairs]),
        conditioning=np.array([conditioning(s) for s in sessions]),
    )
