"""χ² of events that may have happened on a stand."""

import numpy as np

from estimator.health.stand_events import chi_squares


def test_rounding_that_is_left_of_no_information_is_no_event() -> None:
    """Two dates of a stand between which only units without information on it were measured have no event."""
    known, nothing = np.diag([4e9, 2e9, 1e9]), np.zeros((3, 3))
    rounding = nothing.copy()
    rounding[1, :2] = 6e-8, 8e-6
    chi2, seen = chi_squares(np.array([[2e5, 0.0, 0.0], [0.0, 1e-10, 0.0]]), np.array([known, rounding]),
                             np.array([known, nothing]))  # fmt: skip
    assert seen.tolist() == [True, False]
    np.testing.assert_allclose(chi2, [10.0, 0.0], rtol=1e-6)
