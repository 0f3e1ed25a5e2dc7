"""The Cramér–Rao bound, from the equations of the convention page and numerical derivatives alone.

Nothing here uses the estimator's own vectors, Jacobians or normal matrices: the stand is a chain of rotations, the
covariance of all readings is written out in full, common stand errors included.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation

from estimator import CalibrationSession
from estimator.arrays import tangents
from estimator.parameters import SensorParameters
from estimator.session import ACCELEROMETER, Array
from tests.builders import EARTH_RATE, GRAVITY
from tests.estimator.calibration.cases import Case

CONSTANT = ("theta_x", "theta_y", "alpha", "latitude", "meridian", "count_time")
PLAUSIBLE = 0.1
"""Plausible size of an element, dimensionless: the weak prior that the results state."""


@dataclass(frozen=True, eq=False)
class Happened:
    """Stand errors of one session: each constant one, and β (R,)."""

    constant: dict[str, float]
    beta: Array | float = 0.0

    def of(self, name: str) -> float:
        """One constant error."""
        return self.constant.get(name, 0.0)


def applied(session: CalibrationSession, kind: str, e: Happened) -> Array:
    """(R, 3) vectors that the stand applies, block axes: rotations about level Z and Y, then X (raise), then Y (turn).

    The head points south, so that X is west; raised by A above the horizon it is χ = A + φ − 90° above the equator.
    """
    phi = session.site.latitude
    if kind == ACCELEROMETER:
        level, raised = np.array([0.0, 0.0, GRAVITY]), session.stand.alpha
    else:
        seen = phi + e.of("latitude")
        level = EARTH_RATE * np.array([0.0, -np.cos(seen), np.sin(seen)])
        raised = session.stand.chi - phi + np.pi / 2
    turned = Rotation.from_euler("zy", [e.of("meridian"), e.of("theta_y")]).apply(level)
    lifted = Rotation.from_euler("x", -(raised + e.of("theta_x") + e.of("alpha"))).apply(turned)
    platform = Rotation.from_euler("y", -(session.beta + e.beta)[:, None]).apply(lifted)
    platform[session.flipped] = platform[session.flipped] * [-1, -1, 1]
    return platform @ session.mounting.T


def readings(session: CalibrationSession, p: SensorParameters, e: Happened) -> Array:
    """(R, m) K·(a + b + c·a²), times the count time for pulse gyros."""
    columns = []
    for i, sensor in enumerate(session.sensors):
        a = applied(session, sensor.kind, e) @ p.axis[i]
        pulsed = session.count_time is not None and sensor.kind != ACCELEROMETER
        period = session.count_time + e.of("count_time") if pulsed else 1.0
        columns.append(period * p.scale[i] * (a + p.bias[i] + p.quadratic[i] * a**2))
    return np.stack(columns, axis=1)


def nudged(p: SensorParameters, sensor: int, element: int, step: float) -> SensorParameters:
    """The parameters with one element of one sensor moved, SI."""
    name = ("scale", "bias", "quadratic")[element] if element < 3 else "axis"
    column = getattr(p, name).copy()
    column[sensor] = column[sensor] + (step if element < 3 else step * tangents(p.axis[sensor])[:, element - 3])
    return replace(p, **{name: column})


def covariance(case: Case) -> Array:
    """(R m, R m) covariance of all readings of a session on the stand."""
    session, p = case.schedule, case.truth
    pulsed = np.array([session.count_time is not None and s.kind != ACCELEROMETER for s in session.sensors])
    own = np.where(pulsed, case.noise**2 + 1 / 6, case.noise**2)
    zero = p.scale * np.array([s.bias_repeatability for s in session.sensors])
    own = own + (zero * np.where(pulsed, session.count_time or 1.0, 1.0)) ** 2
    V = np.diag(np.broadcast_to(own, session.readings.shape).ravel())
    sigma = session.stand.sigma
    for name in CONSTANT:
        h = getattr(sigma, name)
        G = (readings(session, p, Happened({name: h})) - readings(session, p, Happened({name: -h}))).ravel() / 2
        V += np.outer(G, G)
    swing = (readings(session, p, Happened({}, sigma.beta)) - readings(session, p, Happened({}, -sigma.beta))) / 2
    for j, row in enumerate(swing):
        at = slice(j * len(row), (j + 1) * len(row))
        V[at, at] += np.outer(row, row)
    return V


def stand_bound(case: Case) -> Array:
    """(P, P) SI, on the two-axis stand."""
    session, p = case.schedule, case.truth
    plausible = PLAUSIBLE * np.column_stack(
        [p.scale, case.norm, 1 / case.norm, np.ones_like(case.norm), np.ones_like(case.norm)]
    )
    none, columns = Happened({}), []
    for (sensor, element), size in np.ndenumerate(plausible):
        h = 1e-4 * size
        above, below = (readings(session, nudged(p, sensor, element, s), none) for s in (h, -h))
        columns.append((above - below).ravel() / (2 * h) * size)
    J = np.stack(columns, axis=1)
    information = J.T @ np.linalg.solve(covariance(case), J) + np.eye(J.shape[1])
    return np.linalg.inv(information) * np.outer(plausible, plausible)


def orientation_bound(case: Case) -> Array:
    """(P, P) SI, every orientation unknown; not of the axes, which depend on what holds the frame."""
    p, up = case.truth, case.schedule.directions
    m, R = len(p.scale), len(up)
    information = np.zeros((5 * m + 2 * R, 5 * m + 2 * R))
    repeatability = np.array([s.bias_repeatability for s in case.schedule.sensors])
    variance = (case.noise / p.scale) ** 2 + repeatability**2
    for j, d in enumerate(up):
        for i in range(m):
            row, frame, a = np.zeros(len(information)), tangents(p.axis[i]), GRAVITY * p.axis[i] @ d
            row[5 * i : 5 * i + 5] = [a + p.bias[i], GRAVITY, a**2 / GRAVITY, *(GRAVITY * frame.T @ d)]
            row[5 * m + 2 * j : 5 * m + 2 * j + 2] = GRAVITY * p.axis[i] @ tangents(d)
            information += np.outer(row, row) / variance[i]
    found = np.linalg.pinv(information, rcond=1e-12, hermitian=True)[: 5 * m, : 5 * m]
    units = np.column_stack([p.scale, *np.full((m, 2), [GRAVITY, 1 / GRAVITY]).T, *np.full((2, m), np.nan)]).ravel()
    return found * np.outer(units, units)


@cache
def bound(case: Case) -> Array:
    """(P, P) the least covariance that any unbiased estimate can have, SI; NaN where it is not compared."""
    return stand_bound(case) if case.on_stand else orientation_bound(case)
