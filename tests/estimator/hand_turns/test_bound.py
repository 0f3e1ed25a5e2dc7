"""The stated covariance is the inverse of an information written out by brute force."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.hands.known_noise import known_noise
from estimator import CalibrationSession, Sensor, Site, calibrate
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, GYROSCOPE, RawRests
from tests.estimator.hand_turns import bound

STEP, REST, TURN, RESTS = 0.07, 10, 14, 12
NOISE = {ACCELEROMETER: 2e-3, GYROSCOPE: 5e-3}
"""One sigma of a rest's mean, m/s², and of a sample, rad/s."""


def smooth_rates(rng):
    """(RESTS − 1, TURN, 3) rad/s: turns of some 100° about axes that wander."""
    fade = np.sin(np.pi * (np.arange(TURN) + 0.5) / TURN) ** 2
    swing = np.sin(2 * np.pi * np.arange(TURN)[:, None] / TURN + rng.uniform(0, 6, (RESTS - 1, 1, 3)))
    axes = rng.standard_normal((RESTS - 1, 1, 3))
    return fade[:, None] * (3.0 * axes / np.linalg.norm(axes, axis=2, keepdims=True) + 0.5 * swing)


def unknowns(m, rng):
    """x as `bound.readings` takes it: S and β of the gyros, exact accelerometers, first up, rates."""
    turn = 2 * np.pi * np.arange(m) / m
    axes = np.eye(3) if m == 3 else np.column_stack([np.cos(turn), np.sin(turn), np.full(m, 0.8)]) / 1.28
    gyros = np.column_stack([axes + 0.02 * rng.standard_normal((m, 3)), 0.01 * rng.standard_normal(m)])
    accelerometers = np.column_stack([np.eye(3), [0.05, -0.03, 0.02]])
    return np.concatenate([gyros.ravel(), accelerometers.ravel(), [0.3, -0.2], smooth_rates(rng).ravel()])


def session(x, m):
    """The session without noise that reads just so, at the pole, where the Earth's rate is known."""
    read = bound.readings(x, m, (RESTS - 1, TURN), STEP)
    each = 3 + m + m * TURN
    starts = each * np.arange(RESTS)
    rows = np.stack([read[a : a + 3 + m] for a in starts])
    turns = [read[a + 3 + m : a + each].reshape(TURN, m) for a in starts[:-1]]
    samples = []
    for row, turn in zip(rows, [*turns, np.zeros((0, m))], strict=True):
        samples += [np.tile(row, (REST, 1)), np.column_stack([np.tile(row[:3], (len(turn), 1)), turn])]
    start = (REST + TURN) * np.arange(RESTS)
    sensors = [Sensor(f"A{i}", ACCELEROMETER, np.eye(3)[i], 1.0, "m/s²") for i in range(3)]
    axes = x[: 4 * m].reshape(m, 4)[:, :3]
    sensors += [Sensor(f"G{i}", GYROSCOPE, e / np.linalg.norm(e), 1.0, "rad/s") for i, e in enumerate(axes)]
    noise = [NOISE[ACCELEROMETER]] * 3 + [NOISE[GYROSCOPE] / REST**0.5] * m
    return CalibrationSession(
        unit="T-1", block=ACCELEROMETER, programme=ARBITRARY_ORIENTATIONS, sensors=tuple(sensors), readings=rows,
        standard_errors=np.tile(noise, (RESTS, 1)), position=np.arange(RESTS),
        site=Site(latitude=np.pi / 2, gravity=bound.GRAVITY),
        rests=RawRests(np.concatenate(samples), None, 1 / STEP, start, start + REST),
    )  # fmt: skip


def as_reported(x, m, tangents):
    """(4 m, 4 m) derivative of scale, bias and the axis' turns of every gyro by its S and β."""
    full = np.zeros((m, 4, m, 4))
    for i in range(m):
        S, beta = x[4 * i : 4 * i + 3], x[4 * i + 3]
        K = np.linalg.norm(S)
        full[i, 0, i, :3], full[i, 1, i, :3], full[i, 1, i, 3] = S / K, -beta * S / K**3, 1 / K
        full[i, 2:, i, :3] = tangents[i].T / K
    return full.reshape(4 * m, 4 * m)


@pytest.mark.parametrize("m", [3, 5])
def test_the_covariance_is_the_bound(m):
    x = unknowns(m, np.random.default_rng(m))
    known = known_noise(session(x, m), NOISE[GYROSCOPE]).known
    sigma = np.concatenate(
        [
            part
            for k in range(RESTS)
            for part in (
                np.full(3, NOISE[ACCELEROMETER]),
                np.full(m, NOISE[GYROSCOPE] / REST**0.5),
                np.full(m * TURN if k < RESTS - 1 else 0, NOISE[GYROSCOPE]),
            )
        ]
    )
    J = as_reported(x, m, known.parameters.axis_tangents)
    expected = J @ bound.covariance(x, m, (RESTS - 1, TURN), STEP, sigma) @ J.T
    at = np.flatnonzero(known.observable)
    found = known.covariance[np.ix_(at, at)]
    size = np.sqrt(np.diagonal(expected))
    assert found / np.outer(size, size) == pytest.approx(expected / np.outer(size, size), abs=0.03)


def test_without_the_samples_the_gyros_keep_their_biases_alone():
    x = unknowns(3, np.random.default_rng(3))
    result = calibrate(replace(session(x, 3), rests=None), quadratic=False)
    assert [s.observable["scale"] for s in result.sensors] == [True] * 3 + [False] * 3
    assert all(s.observable["bias"] for s in result.sensors)
