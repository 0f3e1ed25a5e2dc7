"""The score of a candidate from its score vector and information."""

import numpy as np
import pytest

from estimator.groups.scores import FAINT, batch, eigen_whitening


@pytest.mark.parametrize("faint", [0.01, 0.018, 0.022, 0.028, 0.04, 0.2])
def test_a_direction_is_an_amplitude_of_its_own_as_it_is_within_one_session(faint: float) -> None:
    share = (1 - faint**2) / (1 + faint**2)
    alike = np.array([[[1.0, share], [share, 1.0]]])
    _, within = eigen_whitening(alike, np.ones((1, 2), dtype=bool), FAINT)
    size = np.array([3.0, 40.0])
    _, freedom = batch(np.ones((1, 2)), alike * np.outer(size, size))
    assert freedom.tolist() == within.tolist()
