"""Detection of changes: uniform p-values where nothing happens, kinds, dates and sizes where something does."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.detection import Detected, detect
from estimator.health.fits import Readings
from estimator.health.pooled import general_prior
from estimator.health.prognosis import Track, prognosis
from estimator.health.shapes import Kind
from estimator.session import Array
from tests.estimator.health.histories import SIGMA, dates, measured, readings, walk

RUNS = 150


def found(of: Readings, *, usual_walk: float = 0.0, dof: float = np.inf, temperature: Array | None = None) -> Detected:
    n = len(of.time)
    warm = np.full(n, np.nan) if temperature is None else temperature
    return detect(of, usual_walk, np.full(n, dof), warm, 0.01)


def still(rng: np.random.Generator, sessions: int, components: int = 1) -> Readings:
    return readings(measured(rng, dates(rng, sessions), np.zeros((sessions, components))))


@pytest.mark.slow
@pytest.mark.parametrize(("sessions", "components"), [(2, 1), (3, 2), (10, 1), (8, 2), (25, 1)])
def test_p_values_are_uniform_where_nothing_happens(sessions: int, components: int) -> None:
    rng = np.random.default_rng([1, sessions, components])
    p = [found(still(rng, sessions, components)).p_value for _ in range(RUNS)]
    assert stats.kstest(p, "uniform").pvalue > 1e-3
    for level in (0.2, 0.05):
        low, high = stats.binom.ppf(np.array([5e-4, 1 - 5e-4]), RUNS, level)
        assert low <= np.sum(np.array(p) < level) <= high


def test_p_values_are_uniform_where_the_walk_is_what_the_type_does() -> None:
    rng = np.random.default_rng(2)
    p = []
    for _ in range(RUNS):
        t = dates(rng, 8)
        p.append(found(readings(measured(rng, t, walk(rng, t, 0.25))), usual_walk=0.25).p_value)
    assert stats.kstest(p, "uniform").pvalue > 1e-3


@pytest.mark.slow
@pytest.mark.parametrize("components", [1, 2])
def test_noise_that_is_estimated_from_few_readings_raises_no_more_alarms(components: int) -> None:
    """Sigmas with three degrees of freedom each; taken for known they give many times as many alarms."""
    rng = np.random.default_rng(3)
    known, estimated = [], []
    for _ in range(RUNS):
        one = still(rng, 5, components)
        scale = np.sqrt(rng.chisquare(3, (5, 1)) / 3)
        guessed = Readings(one.time, one.value, one.sigma * scale, one.base, one.now)
        known.append(found(guessed).p_value)
        estimated.append(found(guessed, dof=3.0).p_value)
    assert np.sum(np.array(estimated) < 0.01) <= stats.binom.isf(1e-3, RUNS, 0.02)
    assert np.sum(np.array(known) < 0.01) > stats.binom.isf(1e-3, RUNS, 0.02)


def test_a_jump_has_its_dates_and_its_size() -> None:
    rng = np.random.default_rng(4)
    t = np.linspace(0, 3, 10)
    (change,) = found(readings(measured(rng, t, np.where(t > 1.5, 0.8, 0.0)))).changes
    assert (change.kind, change.gap) == (Kind.JUMP, 5)
    assert abs(change.size[0] - 0.8) < 3 * change.sigma[0]


@pytest.mark.parametrize(("course", "kind"), [
    (lambda t: 0.6 * t, (Kind.START,)),
    (lambda t: 0.9 * np.maximum(t - 1.2, 0), (Kind.LATE,)),
    (lambda t: -np.log1p(t / 0.1) / 2.4, (Kind.AGING,)),
])  # fmt: skip
def test_a_drift_is_known_for_what_it_is(course: object, kind: tuple[Kind, ...]) -> None:
    t = np.linspace(0, 3, 12)
    one = measured(np.random.default_rng(5), t, course(t), sigma=0.03)  # type: ignore[operator]
    assert found(readings(one)).changes[0].kind in kind


@pytest.mark.slow
def test_the_size_of_a_drift_is_as_uncertain_as_stated() -> None:
    rng = np.random.default_rng(6)
    t = np.linspace(0, 3, 8)
    pulls = []
    for _ in range(200):
        change = found(readings(measured(rng, t, 0.5 * t))).changes[0]
        if change.kind is Kind.START:
            pulls.append((change.size[0] - 0.5) / change.sigma[0])
    assert len(pulls) > 100
    assert np.mean(np.abs(pulls) < 2) > 0.9


def test_two_jumps_are_found_one_after_another() -> None:
    t = np.linspace(0, 4, 16)
    truth = np.where(t > 1, 0.8, 0.0) - np.where(t > 3, 1.5, 0.0)
    changes = found(readings(measured(np.random.default_rng(7), t, truth, sigma=0.03))).changes
    assert {change.gap for change in changes} == {int(np.argmax(t > 1)), int(np.argmax(t > 3))}


def test_what_wanders_is_said_to_wander() -> None:
    rng = np.random.default_rng(8)
    t = np.linspace(0, 10, 40)
    kinds = [found(readings(measured(rng, t, walk(rng, t, 0.5), sigma=0.02))).changes[0].kind for _ in range(10)]
    assert kinds.count(Kind.WALK) >= 8


def test_a_parameter_that_follows_the_temperature_does_not_drift() -> None:
    rng = np.random.default_rng(9)
    t = dates(rng, 12)
    warm = 21 + 5 * np.sin(2 * np.pi * t)
    seen = found(readings(measured(rng, t, 0.04 * warm, sigma=0.03)), temperature=warm)
    assert seen.warmth is not None
    assert seen.warmth.is_found
    assert abs(seen.warmth.coefficient[0] - 0.04) < 3 * seen.warmth.sigma[0]
    assert seen.changes == ()


def test_a_drift_is_not_taken_for_the_temperature_that_rose_meanwhile() -> None:
    rng = np.random.default_rng(10)
    t = np.linspace(0, 3, 12)
    warm = 20 + 3 * rng.standard_normal(12) + 0.5 * t
    seen = found(readings(measured(rng, t, 0.5 * t, sigma=0.03)), temperature=warm)
    assert [change.kind for change in seen.changes] == [Kind.START]


def test_a_laboratory_that_keeps_its_temperature_tells_of_no_coefficient() -> None:
    rng = np.random.default_rng(11)
    assert found(still(rng, 10), temperature=21 + 0.3 * rng.standard_normal(10)).warmth is None


def test_sessions_of_one_day_show_no_drift() -> None:
    one = Readings(np.zeros(3), np.array([[0.0], [0.1], [-0.1]]), np.full((3, 1), SIGMA), np.ones((3, 1)), np.ones(1))
    assert found(one).p_value > 0.01


def test_alarms_over_all_parameters_of_a_unit_are_as_rare_as_stated() -> None:
    rng = np.random.default_rng(12)
    alarms = 0
    for _ in range(24):
        t = dates(rng, 6)
        unit = [measured(rng, t, np.zeros((6, 1 + i % 2))) for i in range(8)]
        alarms += any(o.changes for o in prognosis(unit, [general_prior()] * 8, np.zeros(1)).outlooks)
    assert alarms <= stats.binom.isf(1e-3, 24, 0.01)


def test_an_outlook_does_not_depend_on_the_unit_of_measurement() -> None:
    rng = np.random.default_rng(13)
    t = dates(rng, 8)
    one = measured(rng, t, np.outer(t, [0.2, 0.3]))
    same = Track(one.time, 10 * one.change, 10 * one.sigma, 10.0)
    ours, theirs = (prognosis([x], [general_prior()], np.zeros(1)).outlooks[0] for x in (one, same))
    assert theirs.rate == pytest.approx(10 * ours.rate)
    assert theirs.level_sigma == pytest.approx(10 * ours.level_sigma)
    assert theirs.reach_50 == pytest.approx(ours.reach_50)
