"""Effects without a plain amplitude are hidden as strong as asked, and the diagnosis names them at every seed that is
tried: noise beyond the stated one, readings that are clipped, and effects in gyros alone.
"""

from dataclasses import replace

import numpy as np
import pytest

from estimator import diagnose
from estimator.applied_vector import EARTH_RATE, gravity
from estimator.causes.catalogue import cause
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.hiding import HiddenCause, TooWeakError, UnhideableError, hide, hide_any, with_input
from estimator.hiding.clipping import FEWEST_CUT
from estimator.results import ARCSEC
from estimator.session import ACCELEROMETER, GYROSCOPE, CalibrationSession, Sensor, Site, Stand, StandErrors
from estimator.simulate import cone, orientation_schedule, scattered, simulate, stand_schedule, uncounted, whole_pulses

SITE = Site(latitude=float(np.radians(55.81)), height=160.0)
SIGMA = StandErrors(theta_x=ARCSEC / 3, theta_y=ARCSEC / 3, alpha=ARCSEC, beta=ARCSEC, latitude=ARCSEC, meridian=ARCSEC)
SEEDS = range(2)
"""Chosen before they were looked at."""
NORM = {ACCELEROMETER: gravity(SITE), GYROSCOPE: EARTH_RATE}
PULSES = 1 / (0.6 * ARCSEC)
"""A rad."""
WANDER = 6.5e-8
"""rad/s: a third of 0.04 °/h, from position to position; two pulses."""


def sensors(kind: str, count: int, scale: float) -> tuple[Sensor, ...]:
    axes = cone(count, float(np.arccos(1 / np.sqrt(3))))
    return tuple(Sensor(f"{kind[0]}{i}", kind, axis, scale, "1") for i, axis in enumerate(axes))


def measured(schedule: CalibrationSession, noise, seed: int, count: int = 1) -> list[CalibrationSession]:
    """Sessions of one unit, the pulses of the last not counted yet."""
    rng = np.random.default_rng([seed, 7])
    norm = np.array([NORM[one.kind] for one in schedule.sensors])
    truth = scattered(schedule.sensors, norm, rng)
    before = [simulate(schedule, truth, rng, noise=noise) for _ in range(count - 1)]
    return [*before, uncounted(schedule, truth, rng, noise=noise)]


def on_stand(kind: str, seed: int, count: int = 1, wander: float = WANDER) -> list[CalibrationSession]:
    """Six accelerometers, or six pulse gyros whose zeros wander."""
    gyro, angle = kind == GYROSCOPE, float(np.radians(40))
    stand = Stand("S", alpha=None if gyro else angle, chi=angle if gyro else None, sigma=SIGMA)
    own = [
        replace(one, bias_repeatability=wander if gyro else 0.0) for one in sensors(kind, 6, PULSES if gyro else 0.12)
    ]
    schedule = stand_schedule(own, stand, SITE, 24, period=120.0, count_time=100.0 if gyro else None)
    return measured(schedule, 0.3 if gyro else 3e-6, seed, count)


def in_orientations(seed: int) -> list[CalibrationSession]:
    """Three accelerometers and three rate gyros."""
    own = (*sensors(ACCELEROMETER, 3, 0.12), *sensors(GYROSCOPE, 3, 1.0))
    directions = np.random.default_rng([seed, 8]).standard_normal((24, 3))
    return measured(orientation_schedule(own, SITE, directions), np.array([3e-5] * 3 + [3e-4] * 3), seed)


def hidden_in(sessions: list[CalibrationSession], name: str, seed: int) -> tuple[CalibrationSession, HiddenCause]:
    return hide(sessions, cause(name), np.random.default_rng([seed, 9]), strength=12.0, exact=False)


CASES = {
    "noise of an accelerometer": ("excess-noise", lambda seed: on_stand(ACCELEROMETER, seed)),
    "noise of a gyro": ("excess-noise", lambda seed: on_stand(GYROSCOPE, seed)),
    "clipped accelerometer": ("saturation", lambda seed: on_stand(ACCELEROMETER, seed)),
    "clipped gyro": ("saturation", lambda seed: on_stand(GYROSCOPE, seed)),
    "clipped in orientations": ("saturation", in_orientations),
    "meridian": ("meridian-error", lambda seed: on_stand(GYROSCOPE, seed)),
    "meridian, less than a pulse": ("meridian-error", lambda seed: on_stand(GYROSCOPE, seed, wander=0.0)),
    "latitude": ("latitude-entry", lambda seed: on_stand(GYROSCOPE, seed, 2)),
    "gravity": ("g-sensitivity", in_orientations),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_the_diagnosis_names_it_at_every_seed(case: str) -> None:
    name, made = CASES[case]
    for seed in SEEDS:
        *before, last = sessions = made(seed)
        session, hidden = hidden_in(sessions, name, seed)
        named = {last.sensors[i].name for i in hidden.sensors}
        findings = diagnose(session, history=before).to_dict()["findings"]
        assert [(f["cause"], set(f["sensors"])) for f in findings[:1]] == [(name, named)], seed


def test_part_of_a_pulse_is_neither_lost_nor_made_whole() -> None:
    [session] = on_stand(GYROSCOPE, 1, wander=0.0)
    setting, plain = baseline_of(whole_pulses(session)).setting, whole_pulses(session).readings
    part = np.full(plain.shape, 0.3) / setting.parameters.scale / 100.0
    gained = with_input(session, setting, part).readings - plain
    assert set(np.unique(gained)) == {0.0, 1.0}
    assert abs(gained.mean() - 0.3) < 4 * np.sqrt(0.3 * 0.7 / gained.size)


def test_nothing_is_added_to_pulses_that_are_counted() -> None:
    counted = whole_pulses(on_stand(GYROSCOPE, 1)[0])
    with pytest.raises(ValueError, match="counted already"):
        hide([counted], cause("meridian-error"), np.random.default_rng(1), strength=12.0)


@pytest.mark.parametrize("kind", [ACCELEROMETER, GYROSCOPE])
def test_a_clipped_sensor_stands_at_its_limit_twice_at_every_end(kind: str) -> None:
    [plain] = on_stand(kind, 1)
    sides = set()
    for seed in range(8):
        session, hidden = hidden_in([plain], "saturation", seed)
        (i,), (_, side) = hidden.sensors, hidden.nonlinear
        own = session.readings[:, i]
        ends = [sign * own for sign in (1.0, -1.0) if side in (0.0, sign)]
        assert all((end == end.max()).sum() >= FEWEST_CUT for end in ends)
        assert len({end.max() for end in ends}) == 1
        sides.add(side)
    assert sides == {0.0, 1.0, -1.0}


@pytest.mark.parametrize(("kind", "strength"), [(ACCELEROMETER, 9000.0), (GYROSCOPE, 60.0)])
def test_clipping_is_as_strong_as_asked(kind: str, strength: float) -> None:
    """A gyro is right to half a pulse of the limit, a fifth of the noise of a reading."""
    [plain] = on_stand(kind, 2)
    for seed in range(4):
        _, hidden = hide([plain], cause("saturation"), np.random.default_rng(seed), strength=strength)
        assert hidden.strength == pytest.approx(strength, abs=1.0)


def test_where_clipping_cannot_be_as_weak_the_least_is_told_and_can_be_had() -> None:
    [plain] = on_stand(ACCELEROMETER, 1)
    with pytest.raises(TooWeakError, match="two positions") as fault:
        hide([plain], cause("saturation"), np.random.default_rng(1), strength=12.0)
    least = fault.value.least
    assert least > 1000
    _, hidden = hide([plain], cause("saturation"), np.random.default_rng(1), strength=least)
    assert hidden.strength == pytest.approx(least)


def test_the_limit_that_is_hidden_is_the_limit_found() -> None:
    [plain] = on_stand(ACCELEROMETER, 3)
    session, hidden = hidden_in([plain], "saturation", 3)
    found = diagnose(session).findings[0]
    assert all(abs(a - hidden.amplitude[0]) < 4 * s for a, s in zip(found.amplitude, found.sigma, strict=True))


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
