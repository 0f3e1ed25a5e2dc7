"""χ² of events that may have happened on a stand."""

import numpy as np

from estimator.health.stand_events import chi_squares


def test_rounding_that_is_left_of_no_information_is_no_event() -> None:
    """As between two dates of a stand on which only units were measured that say nothing of it."""
    told, nothing = np.diag([4e9, 2e9, 1e9]), np.zeros((3, 3))
    rounding = nothing.copy()
    rounding[1, :2] = 6e-8, 8e-6
    chi2, seen = chi_squares(np.array([[2e5, 0.0, 0.0], [0.0, 1e-10, 0.0]]), np.array([told, rounding]),
                             np.array([told, nothing]))  # fmt: skip
    assert seen.tolist() == [True, False]
    np.testing.assert_allclose(chi2, [10.0, 0.0], rtol=1e-6)
