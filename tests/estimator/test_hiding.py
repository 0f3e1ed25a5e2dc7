"""What has no plain amplitude is hidden as strong as asked, and the diagnosis names it at every seed that is tried:
noise beyond the stated one, readings that are clipped, and what gyros alone see."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import diagnose
from estimator.applied_vector import EARTH_RATE, gravity
from estimator.causes.catalogue import cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.hiding import FEWEST_CUT, Hidden, UnhideableError, hide, hide_any
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE, CalibrationSession, Sensor, Site, Stand, StandErrors
from estimator.simulate import cone, orientation_schedule, scattered, simulate, stand_schedule

SITE = Site(latitude=float(np.radians(55.81)), height=160.0)
SIGMA = StandErrors(theta_x=ARCSEC / 3, theta_y=ARCSEC / 3, alpha=ARCSEC, beta=ARCSEC, latitude=ARCSEC, meridian=ARCSEC)
SEEDS = range(3)
"""Chosen before they were looked at."""
NORM = {ACCELEROMETER: gravity(SITE), GYROSCOPE: EARTH_RATE}
PULSES = 1 / (0.6 * ARCSEC)
"""A rad."""
WANDER = 6.5e-8
"""rad/s: a third of 0.04 °/h, from position to position; more than a pulse's rounding, as it is of any such gyro."""


def sensors(kind: str, count: int, scale: float) -> tuple[Sensor, ...]:
    axes = cone(count, float(np.arccos(1 / np.sqrt(3))))
    return tuple(Sensor(f"{kind[0]}{i}", kind, axis, scale, "1") for i, axis in enumerate(axes))


def measured(schedule: CalibrationSession, noise, seed: int, count: int = 1) -> list[CalibrationSession]:
    """Sessions of one unit."""
    rng = np.random.default_rng([seed, 7])
    norm = np.array([NORM[one.kind] for one in schedule.sensors])
    truth = scattered(schedule.sensors, norm, rng)
    return [simulate(schedule, truth, rng, noise=noise) for _ in range(count)]


def on_stand(kind: str, seed: int, count: int = 1) -> list[CalibrationSession]:
    """Six accelerometers, or six pulse gyros."""
    gyro, angle = kind == GYROSCOPE, float(np.radians(40))
    stand = Stand("S", alpha=None if gyro else angle, chi=angle if gyro else None, sigma=SIGMA)
    own = [
        replace(one, bias_repeatability=WANDER if gyro else 0.0) for one in sensors(kind, 6, PULSES if gyro else 0.12)
    ]
    schedule = stand_schedule(own, stand, SITE, 24, period=120.0, count_time=100.0 if gyro else None)
    return measured(schedule, 0.3 if gyro else 3e-6, seed, count)


def in_orientations(seed: int) -> list[CalibrationSession]:
    """Three accelerometers and three rate gyros."""
    own = (*sensors(ACCELEROMETER, 3, 0.12), *sensors(GYROSCOPE, 3, 1.0))
    directions = np.random.default_rng([seed, 8]).standard_normal((24, 3))
    return measured(orientation_schedule(own, SITE, directions), np.array([3e-5] * 3 + [3e-4] * 3), seed)


def hidden_in(sessions: list[CalibrationSession], name: str, seed: int) -> tuple[CalibrationSession, Hidden]:
    return hide(sessions, cause(name), np.random.default_rng([seed, 9]), strength=12.0)


CASES = {
    "noise of an accelerometer": ("excess-noise", lambda seed: on_stand(ACCELEROMETER, seed)),
    "noise of a gyro": ("excess-noise", lambda seed: on_stand(GYROSCOPE, seed)),
    "clipped accelerometer": ("saturation", lambda seed: on_stand(ACCELEROMETER, seed)),
    "clipped gyro": ("saturation", lambda seed: on_stand(GYROSCOPE, seed)),
    "clipped in orientations": ("saturation", in_orientations),
    "meridian": ("meridian-error", lambda seed: on_stand(GYROSCOPE, seed)),
    "latitude": ("latitude-entry", lambda seed: on_stand(GYROSCOPE, seed, 2)),
    "gravity": ("g-sensitivity", in_orientations),
}


@pytest.mark.parametrize("case", CASES)
def test_the_diagnosis_names_it_at_every_seed(case: str) -> None:
    name, made = CASES[case]
    for seed in SEEDS:
        *before, last = sessions = made(seed)
        session, hidden = hidden_in(sessions, name, seed)
        named = {last.sensors[i].name for i in hidden.sensors}
        findings = diagnose(session, history=before).to_dict()["findings"]
        assert [(f["cause"], set(f["sensors"])) for f in findings[:1]] == [(name, named)], seed


def test_a_clipped_sensor_reads_one_and_the_same_at_its_limit() -> None:
    [plain] = on_stand(ACCELEROMETER, 1)
    session, hidden = hidden_in([plain], "saturation", 1)
    [i] = hidden.sensors
    changed = session.readings != plain.readings
    at_limit = session.readings[changed[:, i], i]
    assert changed.sum() == changed[:, i].sum() >= FEWEST_CUT
    assert len(np.unique(np.abs(at_limit - at_limit.mean()).round(15))) <= 2
    assert hidden.strength is not None
    assert hidden.strength >= 12


def test_noise_is_as_strong_as_asked() -> None:
    """The gain of twice the log-likelihood, averaged over draws of the noise that was hidden, is 12 squared."""
    [plain] = on_stand(ACCELEROMETER, 2)
    seen = WhitenedResiduals.of(baseline_of(plain))
    _, hidden = hidden_in([plain], "excess-noise", 2)
    (i,), (k,) = hidden.sensors, hidden.amplitude
    R, m = plain.readings.shape
    one = np.zeros((R, m, R))
    one[np.arange(R), i, np.arange(R)] = k
    left = seen.trace(one)
    noise = np.random.default_rng(3).standard_normal((4000, R + len(left)))
    z = noise[:, :R] @ left.T + noise[:, R:]
    grown = np.eye(len(left)) + left @ left.T
    gained = np.einsum("nj,nj->n", z, z - np.linalg.solve(grown, z.T).T) - np.linalg.slogdet(grown)[1]
    assert abs(gained.mean() - 144.0) < 4 * gained.std() / np.sqrt(len(gained))


def test_any_effect_may_be_drawn_in_orientations() -> None:
    sessions = in_orientations(1)
    drawn = {hide_any(sessions, np.random.default_rng(k), strength=12.0)[1].cause for k in range(12)}
    assert len(drawn) > 3


def test_where_it_cannot_be_as_strong_that_is_said() -> None:
    for name in ("saturation", "excess-noise"):
        with pytest.raises(UnhideableError, match=r"would not reach 1e\+12"):
            hide(on_stand(ACCELEROMETER, 1), cause(name), np.random.default_rng(1), strength=1e12)
    with pytest.raises(UnhideableError, match="is of a gyroscope"):
        hide(on_stand(ACCELEROMETER, 1), cause("meridian-error"), np.random.default_rng(1), strength=12.0)
