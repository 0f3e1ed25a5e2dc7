"""The course without a formula is found with its sizes, and its evidence pays for its freedom."""

import numpy as np
import pytest

from estimator.causes.shared import KINDS, WAVES, kind_of, of_kind, walking_rate
from estimator.diagnosis.posterior.free_course import FreeCourse

ROWS, SENSORS = 30, 8


def traces(waves: np.ndarray) -> np.ndarray:
    """(R·m, m·w) every one of the waves (R, w) on every sensor, the mean of each absorbed."""
    return np.einsum("rw,ij->rijw", waves - waves.mean(axis=0), np.eye(SENSORS)).reshape(ROWS * SENSORS, -1)


def course_of(z: np.ndarray) -> FreeCourse:
    """The likeliest course of residuals z (R·m,)."""
    trace = traces(walking_rate(ROWS))
    square = (trace.T @ trace).reshape(SENSORS, WAVES, SENSORS, WAVES)
    return FreeCourse.of_products(square, (trace.T @ z).reshape(SENSORS, WAVES))


def test_a_smooth_course_is_found_with_its_sizes() -> None:
    rng = np.random.default_rng(3)
    course = np.sin(np.linspace(0, 5, ROWS))
    sizes = rng.normal(0, 3, SENSORS)
    z = np.outer(course - course.mean(), sizes).ravel() + rng.standard_normal(ROWS * SENSORS)
    found = course_of(z)
    read = walking_rate(ROWS) @ found.waves
    assert abs(np.corrcoef(read, course)[0, 1]) > 0.97
    assert abs(np.corrcoef(found.sizes, sizes)[0, 1]) > 0.97
    assert found.log_evidence > 30


def test_noise_has_none() -> None:
    rng = np.random.default_rng(4)
    found = [course_of(rng.standard_normal(ROWS * SENSORS)).log_evidence for _ in range(20)]
    assert max(found) < 0


def test_courses_of_each_its_own_are_not_one() -> None:
    rng = np.random.default_rng(5)
    own = walking_rate(ROWS) @ rng.standard_normal((WAVES, SENSORS)) * 20
    z = (own - own.mean(axis=0)).ravel() + rng.standard_normal(ROWS * SENSORS)
    found = course_of(z)
    left = z - traces(walking_rate(ROWS)) @ np.outer(found.sizes, found.waves).ravel()
    assert left @ left > 2 * len(z)


@pytest.mark.parametrize("kind", range(len(KINDS)))
def test_a_shape_says_its_kind(kind: int) -> None:
    sizes = np.linspace(-1, 1, WAVES)
    shape = of_kind(kind, sizes)
    assert kind_of(shape) == kind
    assert np.concatenate([waves(ROWS) for waves in KINDS], axis=1) @ shape == pytest.approx(KINDS[kind](ROWS) @ sizes)
