"""The course without a formula is found with its sizes, and its evidence pays for its freedom."""

import numpy as np

from estimator.causes.shared import WAVES, walking_rate
from estimator.diagnosis.signatures.free_course import FreeCourse

ROWS, SENSORS = 30, 8


def traces() -> np.ndarray:
    """(R·m, m·w) every wave on every sensor, the mean of each absorbed."""
    waves = walking_rate(ROWS)
    return np.einsum("rw,ij->rijw", waves - waves.mean(axis=0), np.eye(SENSORS)).reshape(ROWS * SENSORS, -1)


def test_a_smooth_course_is_found_with_its_sizes() -> None:
    rng = np.random.default_rng(3)
    course = np.sin(np.linspace(0, 5, ROWS))
    sizes = rng.normal(0, 3, SENSORS)
    z = np.outer(course - course.mean(), sizes).ravel() + rng.standard_normal(ROWS * SENSORS)
    found = FreeCourse.of(traces(), z, SENSORS)
    read = walking_rate(ROWS) @ found.waves
    assert abs(np.corrcoef(read, course)[0, 1]) > 0.97
    assert abs(np.corrcoef(found.sizes, sizes)[0, 1]) > 0.97
    assert found.log_evidence > 30


def test_noise_has_none() -> None:
    rng = np.random.default_rng(4)
    found = [FreeCourse.of(traces(), rng.standard_normal(ROWS * SENSORS), SENSORS).log_evidence for _ in range(20)]
    assert max(found) < 0


def test_courses_of_each_its_own_are_not_one() -> None:
    rng = np.random.default_rng(5)
    own = walking_rate(ROWS) @ rng.standard_normal((WAVES, SENSORS)) * 5
    z = (own - own.mean(axis=0)).ravel() + rng.standard_normal(ROWS * SENSORS)
    found = FreeCourse.of(traces(), z, SENSORS)
    left = z - traces() @ np.outer(found.sizes, found.waves).ravel()
    assert left @ left > 2 * len(z)
