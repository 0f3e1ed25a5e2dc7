"""Causes that explain a reading that was set aside as well as an outlier does."""

import numpy as np
import pytest

from estimator.diagnosis.diagnose import diagnose
from tests.estimator.diagnosis.small import ROWS, SENSOR, measured, on_sensor

SOUND = measured().readings[:, SENSOR]
HIGHEST, LOWEST = int(SOUND.argmax()), int(SOUND.argmin())
NEXT = float(np.sort(SOUND)[-1] - np.sort(SOUND)[-2])
"""V, how far the highest reading stands above the second."""
INSIDE = next(row for row in range(1, ROWS - 1) if row not in (HIGHEST, LOWEST))


def possible(rows: int | list[int], off: float) -> tuple[str, ...]:
    """The causes that a session leaves open whose readings in some rows, counted from 0, are off by so much, in
    standard errors."""
    course = np.zeros(ROWS)
    course[rows] = off
    (finding,) = diagnose(measured(on_sensor(course))).findings
    assert sum(rival.probability for rival in finding.ranking) == pytest.approx(1.0)
    return (finding.cause, *finding.alternatives)


def test_a_reading_inside_the_others_is_an_outlier() -> None:
    assert possible(INSIDE, 300.0) == ("reading-outlier",)


def test_a_last_reading_may_be_a_zero_that_jumped() -> None:
    assert possible(ROWS - 1, 300.0) == ("reading-outlier", "bias-jump")


def test_but_no_zero_jumps_by_a_quarter_of_gravity() -> None:
    assert "bias-jump" not in possible(ROWS - 1, 1e5)


@pytest.mark.parametrize(("row", "off", "clipped"), [(HIGHEST, -1.0, True), (HIGHEST, 1.0, False), (LOWEST, 1.0, True)])
def test_the_outermost_reading_may_be_clipped_where_it_falls_short(row: int, off: float, clipped: bool) -> None:
    assert ("saturation" in possible(row, off * 300.0)) == clipped


def test_what_others_exceed_is_no_limit() -> None:
    far = 2 * NEXT / 3e-6
    assert "saturation" not in possible(HIGHEST, -far)


def test_two_outliers_of_one_sensor_may_have_one_cause_that_nobody_knows() -> None:
    assert possible([INSIDE, INSIDE + 6], 300.0) == ("reading-outlier", "unexplained")


def test_what_explains_one_sensor_alone_is_no_alternative_of_two() -> None:
    course = np.zeros(ROWS)
    course[[INSIDE, INSIDE + 6]] = 300.0
    other = np.zeros(ROWS)
    other[INSIDE + 3] = 300.0
    (finding,) = diagnose(measured(on_sensor(course) + on_sensor(other, SENSOR + 1))).findings
    assert (finding.alternatives, [rival.cause for rival in finding.ranking]) == ((), ["reading-outlier"])
