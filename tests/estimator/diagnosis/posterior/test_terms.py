"""Every kind of term: its evidence against the dense normal law, and its effect found where it is hidden."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from estimator.causes.fixture import turned
from estimator.diagnosis.posterior.search import search
from estimator.diagnosis.posterior.solve import SessionTerms
from estimator.diagnosis.posterior.term import COURSE, MOVED, NOISE, Term
from estimator.session import Array
from tests.estimator.diagnosis.posterior.small import places, session_of, sound
from tests.estimator.diagnosis.small import ROWS, SENSOR, TIME, WHERE, effect, measured, on_sensor

PLACE = np.arange(ROWS) / ROWS
WAVE = np.sin(2 * np.pi * 4.5 * PLACE)


@cache
def with_history() -> SessionTerms:
    return session_of(0.0, (measured(0.0, 2), measured(0.0, 3)))


def swayed(size: float) -> Array:
    """(R, m) a sway of the stand, V: no cause of the catalogue."""
    setting = sound().residuals.baseline.setting
    assert setting.d_beta is not None
    added = setting.through(setting.d_beta[..., None])[..., 0] * WAVE[:, None]
    return np.asarray(size * added / np.abs(added).max() * WHERE.noise.max())


@pytest.mark.parametrize("session", [sound, with_history])
def test_every_candidate_is_as_likely_as_the_dense_normal_law_says(session: Callable[[], SessionTerms]) -> None:
    model, T = session().model, session().T
    z = session().residuals.z
    every = [c for kind in model.kinds for c in kind.candidates(model.start)]
    for candidate in (c for c in every if np.isfinite(c.value)):
        term = candidate.term()
        assert candidate.best == pytest.approx(dense(T, z, term) + term.log_prior, abs=1e-6), term.place


def dense(T: Array, z: Array, term: Term) -> float:
    """ln p(z | term) − ln p(z), by the covariance of all residuals."""
    W = T @ term.columns
    mean = np.zeros(W.shape[1]) if term.mean is None else term.mean
    left, covariance = z - W @ mean, np.eye(len(z)) + (W * term.variance) @ W.T
    square = float(z @ z - left @ np.linalg.solve(covariance, left))
    return 0.5 * square - 0.5 * float(np.linalg.slogdet(covariance)[1])


def test_a_sound_session_holds_nothing() -> None:
    assert places(sound()) == []
    assert places(with_history()) == []


@pytest.mark.parametrize("identifier", ["cubic-nonlinearity", "warm-up", "bias-jump", "reading-outlier", "hysteresis"])
def test_a_cause_of_one_sensor(identifier: str) -> None:
    assert places(session_of(effect(identifier))) == [(identifier, (SENSOR,))]


@pytest.mark.parametrize("identifier", ["beta-second-harmonic", "axis-wobble", "flip-misalignment", "stand-drift"])
def test_a_cause_of_the_stand(identifier: str) -> None:
    assert places(session_of(effect(identifier))) == [(identifier, ())]


def test_an_unknown_course_of_one_sensor() -> None:
    assert places(session_of(on_sensor(8 * WAVE))) == [(COURSE, (SENSOR,))]


def test_an_unknown_course_of_the_applied_vector() -> None:
    (term,) = search(session_of(swayed(15.0)).model)
    assert term.place == (COURSE, ())
    assert term.course is not None
    assert term.course.components == ("β",)


def test_a_noisy_sensor() -> None:
    scatter = np.random.default_rng(4).standard_normal(ROWS)
    assert places(session_of(on_sensor(5 * scatter))) == [(NOISE, (SENSOR,))]


def test_a_course_with_a_formula_that_sensors_share() -> None:
    assert TIME is not None
    course = 60 * np.exp(-(TIME - TIME[0]) / (0.3 * np.ptp(TIME)))
    added = sum(on_sensor(size * course, i) for i, size in enumerate((1.0, -0.7, 0.8)))
    assert places(session_of(added)) == [("several-warm-up", (0, 1, 2))]


def test_a_course_without_a_formula_that_sensors_share() -> None:
    course = 25 * np.sin(2 * np.pi * 0.8 * PLACE) * np.exp(-PLACE) + 15 * PLACE**2
    added = sum(on_sensor(size * course, i) for i, size in enumerate((1.0, -0.7, 0.8, 1.3)))
    ((name, sensors),) = places(session_of(added))
    assert (name, sensors) == ("several-shared-course", (0, 1, 2, 3))


def test_zeros_that_wander_each_by_itself() -> None:
    steps = np.random.default_rng(7).standard_normal((4, ROWS))
    found = places(session_of(sum(on_sensor(6 * np.cumsum(steps[i]), i) for i in range(4))))
    assert (COURSE, (0, 1, 2, 3)) in found
    assert not any(name.startswith("several-") for name, _ in found)


def test_a_quadratic_term_that_changed_since_the_history_has_no_name() -> None:
    history = (measured(0.0, 2), measured(0.0, 3))
    bent = 4e-5 * measured().readings[:, SENSOR] ** 2 / 0.12
    assert places(session_of(bent[:, None] * np.eye(4)[SENSOR], history)) == [(MOVED, (SENSOR,))]


def test_a_scale_that_changed_since_the_history_is_a_drift() -> None:
    history = (measured(0.0, 2), measured(0.0, 3))
    grown = 3e-4 * measured().readings * np.eye(4)[SENSOR]
    assert places(session_of(grown, history)) == [("sensor-drift", (SENSOR,))]


def test_a_block_that_turned_since_the_history() -> None:
    setting = sound().residuals.baseline.setting
    added = setting.through(turned(setting.n) @ np.array([1e-4, -1e-4, 5e-5])[:, None])[..., 0]
    history = (measured(0.0, 2), measured(0.0, 3))
    readings = added * setting.parameters.scale
    assert places(session_of(readings, history)) == [("remount-rotation", ())]
