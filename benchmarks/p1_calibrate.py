"""P1: `calibrate` one block session with full covariance, against `scipy.optimize.least_squares` sensor by sensor.

The peer fits the same five parameters of each sensor to the same readings under the same reading noise, from the same
start, and takes each sensor's covariance from its Jacobian. It is given the applied vectors for nothing. What it
leaves out: the stand's errors, which are common to all sensors, and so the covariance between sensors.
"""

from functools import partial

import numpy as np
from scipy.optimize import least_squares

from benchmarks.block import sessions
from benchmarks.figures import Figure, side_by_side
from estimator import CalibrationSession, calibrate
from estimator.applied_vector import Geometry, stand_geometry
from estimator.arrays import tangents
from estimator.calibration.stand import starting_point
from estimator.forward import measured
from estimator.parameters import SensorParameters, nominal
from estimator.session import Array

WORK = "calibrate one session, 6 sensors × 24 positions × 2 runs, full covariance"
PEER = "scipy.optimize.least_squares, sensor by sensor"


def one_sensor(u: Array, sigma: Array, n: Array, norm: float, p: SensorParameters, method: str) -> Array:
    """Covariance (5, 5) of one sensor's parameters, dimensionless, fitted from p, which holds that sensor alone."""
    axis, scale = p.axis, p.scale
    frame = tangents(axis)

    def residual(x: Array) -> Array:
        e = axis + frame @ x[3:]
        a = n @ (e / np.sqrt(e @ e))
        return (u - scale * (1 + x[0]) * (a + x[1] * norm + x[2] / norm * a * a)) / sigma

    found = least_squares(residual, [0.0, p.bias / norm, p.quadratic * norm, 0.0, 0.0], method=method)
    return np.linalg.inv(found.jac.T @ found.jac)


def sensor_by_sensor(session: CalibrationSession, geometry: Geometry, start: SensorParameters, method: str) -> None:
    """The whole block, one sensor after another."""
    u, errors = measured(session)
    for i, sensor in enumerate(session.sensors):
        sigma = np.hypot(errors[:, i], start.scale[i] * sensor.bias_repeatability)
        one_sensor(u[:, i], sigma, geometry.n[:, i], geometry.norm[i], start.at(i), method)


def run() -> list[Figure]:
    """From the nominal values, which is what a session gives: the peer as it comes, and its fastest method.

    And, beyond what a user has, the peer's fastest method from our own closed form, whose time it is not charged.
    """
    session = sessions(1)[0]
    geometry, base = stand_geometry(session), nominal(session.sensors)
    ready = starting_point(session.readings, session, geometry)
    peers = (
        ("P1", PEER, base, "trf", "30"),
        ("P1, MINPACK", f"{PEER}, method lm", base, "lm", "—"),
        ("P1, head start", f"{PEER}, method lm, started at our closed form", ready, "lm", "—"),
    )
    figures = []
    for name, peer, start, method, target in peers:
        theirs = partial(sensor_by_sensor, session, geometry, start, method)
        figures.append(Figure(name, WORK, peer, *side_by_side(partial(calibrate, session), theirs, rounds=60), target))
    return figures
