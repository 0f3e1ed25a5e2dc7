"""The noise that terms leave, where they leave next to nothing."""

from dataclasses import replace

import numpy as np
import pytest

from estimator.diagnosis.posterior.noise import beside
from estimator.diagnosis.residuals.fitted import baseline_of
from tests.estimator.diagnosis.small import ROWS, SENSOR, measured, on_sensor

FREE = 12
"""Rows of which a term takes all that a sensor shows."""


@pytest.mark.parametrize(("taken", "estimable"), [(FREE, True), (ROWS, False)])
def test_noise_is_estimated_from_what_terms_leave_and_else_kept(taken: int, estimable: bool) -> None:
    fitted = baseline_of(measured(on_sensor(3 * np.random.default_rng(4).standard_normal(ROWS))))
    unstated = replace(fitted, unstated=np.arange(4) == SENSOR)
    named = np.zeros((ROWS, 4, taken))
    named[np.arange(taken), SENSOR, np.arange(taken)] = 1.0
    ratio = np.median(beside(unstated, named).variance / fitted.variance, axis=0)
    assert np.delete(ratio, SENSOR) == pytest.approx(1.0)
    assert (ratio[SENSOR] > 1.5) == estimable
    assert (ratio[SENSOR] == pytest.approx(1.0)) == (not estimable)
