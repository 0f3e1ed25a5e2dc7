"""A second generator of turntable sessions, which shares nothing with `estimator.alignment`.

Every sensor's place is followed through inertial space in steps of a hundredth of a second; its specific force is the
second difference of that place less gravity, and a reading the mean over the row. No formula of a lever arm.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from estimator.session import (
    ACCELEROMETER,
    GYROSCOPE,
    ROTATION_ALIGNMENT,
    CalibrationSession,
    Sensor,
    Site,
    Stand,
    StandErrors,
)

Array = NDArray[Any]
LATITUDE, G, EARTH = np.radians(47.0), 9.808, 7.292115e-5
FINE = 0.01
PLACES = ((0.04, -0.08, 0.1), (-0.06, 0.05, 0.0), (0.1, 0.1, 0.1))
"""Positions of three accelerometers, m from the turn axis."""


@dataclass(frozen=True)
class Run:
    """Motion of the table, and errors of the block."""

    stops: tuple[float, ...] = (0.0, 180.0)
    """degrees."""
    dwell: float = 120.0
    rates: tuple[float, ...] = (6.0,)
    """degrees/s of each turn in order, the last for all further ones."""
    ramp: float = 0.8
    """s in which the table comes up to its rate, as a raised cosine."""
    row: float = 0.1
    places: tuple[tuple[float, float, float], ...] = ((0.0, 0.0, 0.0),) * 3
    """Positions of the accelerometers, m from the turn axis."""
    noise: float = 5e-5
    """Noise of an accelerometer, m/s²/√Hz."""
    wobble: float = 0.5
    """One sigma of the axis' direction from stop to stop, arcsec."""
    delay: float = 0.0
    """s by which the accelerometers lag behind the gyros."""
    shaking: float = 0.0
    """m/s² that a vibration of the bearing adds to the zero of the first accelerometer at 6°/s."""
    rough: float = 1.0
    """Noise of the accelerometers while the table turns, over that at rest."""
    zeros: tuple[float, float, float] = (3e-4, -2e-4, 1e-4)
    """Zeros of the accelerometers, m/s²."""
    lean: tuple[float, float] = (2e-4, -4e-4)
    """Lean of the turn axis about east and north, rad."""


def course(run: Run) -> tuple[Array, Array]:
    """Angle of the table and its place between the stops, on the fine grid, whole rows of it."""
    angle, place = [np.full(round(run.dwell / FINE), np.radians(run.stops[0]))], [np.zeros(round(run.dwell / FINE))]
    for k in range(1, len(run.stops)):
        rate = run.rates[min(k, len(run.rates)) - 1]
        turn = np.radians(run.stops[k] - run.stops[k - 1])
        time = np.arange(0, abs(np.degrees(turn)) / rate + run.ramp + 2 * FINE, FINE)
        left = np.minimum(time, abs(np.degrees(turn)) / rate + run.ramp - time)
        speed = 0.5 - 0.5 * np.cos(np.pi * np.clip(left / max(run.ramp, FINE), 0, 1))
        done = np.cumsum(speed) / speed.sum()
        angle += [angle[-1][-1] + turn * done, np.full(round(run.dwell / FINE), np.radians(run.stops[k]))]
        place += [k - 1 + done, np.full(round(run.dwell / FINE), float(k))]
    per_row = round(run.row / FINE)
    whole = np.concatenate(angle), np.concatenate(place)
    rows = len(whole[0]) // per_row
    return whole[0][: rows * per_row], whole[1][: rows * per_row]


def turned(
    run: Run, seed: int = 1, *, stated: Array | None = None, stated_noise: float | None = None
) -> CalibrationSession:
    """A session; ``stated``: positions (3, 3) that the file states, m; ``stated_noise``: times the true one."""
    rng = np.random.default_rng(seed)
    angle, place = course(run)
    arcsec = np.pi / 648000
    leans = run.wobble * arcsec * rng.standard_normal((len(run.stops), 2))
    lean = np.stack([np.interp(place, np.arange(len(run.stops)), column) for column in leans.T], axis=1) + run.lean
    time = FINE * np.arange(len(angle))
    omega = EARTH * np.array([0.0, np.cos(LATITUDE), np.sin(LATITUDE)])
    earth = Rotation.from_rotvec(time[:, None] * omega)
    tilt = Rotation.from_rotvec(np.column_stack([lean, np.full(len(lean), 0.4)]))
    body = earth * tilt * Rotation.from_rotvec(angle[:, None] * [0.0, 0.0, 1.0])
    force = np.stack([_force(body, earth, np.asarray(r))[:, i] for i, r in enumerate(run.places)], axis=1)
    rate = (body[:-1].inv() * body[1:]).as_rotvec() / FINE
    moving = np.abs(np.gradient(angle, FINE))
    force[:, 0] += run.shaking * (moving / np.radians(6.0)) ** 2
    force = 0.5 * (force + np.vstack([force[1:], force[-1:]]))  # in the middle of a fine step, as the rate is
    late = np.stack([np.interp(time - run.delay, time, column) for column in force.T], axis=1)
    per_row = round(run.row / FINE)

    def means(fine: Array) -> Array:
        return fine.reshape(-1, per_row, fine.shape[1]).mean(axis=1)

    late, rate = means(late), means(np.vstack([rate, rate[-1:]]))
    speed = moving.reshape(-1, per_row).mean(axis=1)
    loud = np.where(speed > 1e-4, run.rough, 1.0)[:, None]
    white = run.noise / np.sqrt(run.row)
    readings = np.hstack([
        late + run.zeros + loud * white * rng.standard_normal(late.shape),
        rate + 1e-8 + 3e-7 / np.sqrt(run.row) * rng.standard_normal(rate.shape),
    ])  # fmt: skip
    errors = np.array([white] * 3 + [3e-7 / np.sqrt(run.row)] * 3)
    return CalibrationSession(
        unit="by hand",
        block=GYROSCOPE,
        programme=ROTATION_ALIGNMENT,
        sensors=_sensors(stated),
        readings=readings,
        standard_errors=np.tile(errors * (np.nan if stated_noise is None else stated_noise), (len(readings), 1)),
        site=Site(latitude=float(LATITUDE), gravity=G),
        stand=Stand("turntable", sigma=StandErrors(beta=run.wobble * arcsec, wobble=run.wobble * arcsec)),
        time=run.row * np.arange(1, len(readings) + 1),
        turn_angle=np.append(angle, angle[-1])[per_row::per_row],
    )


def _force(body: Rotation, earth: Rotation, r: Array) -> Array:
    """(F, 3) specific force in the block at r: second difference of its place in inertial space, less gravity."""
    where = body.apply(r)
    second = np.zeros_like(where)
    second[1:-1] = (where[2:] - 2 * where[1:-1] + where[:-2]) / FINE**2
    return np.asarray(body.inv().apply(second + earth.apply([0.0, 0.0, G])))


def _sensors(stated: Array | None) -> tuple[Sensor, ...]:
    axes = np.eye(3)
    places = [None] * 3 if stated is None else list(stated)
    return (
        *(Sensor(f"A{i + 1}", ACCELEROMETER, axes[i], 1.0, "m/s2", position=places[i]) for i in range(3)),
        *(Sensor(f"G{i + 1}", GYROSCOPE, axes[i], 1.0, "rad/s") for i in range(3)),
    )
