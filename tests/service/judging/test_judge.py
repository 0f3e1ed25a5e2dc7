"""A session's verdict: by one rule wherever it is asked, and none of a sensor for a turn of its block."""

import numpy as np

from estimator.results import ARCSEC
from service.judging.judge import decisions_of, judge
from service.sessions.decision import Verdict
from service.types.records import Tolerances, UnitType
from tests.estimator.health.cases import block
from tests.estimator.test_rotations import unit_vectors

KIND = UnitType("hex-cone", "accelerometer", (), (), (), Tolerances(1e-4, 5e-4, 2e-6, 20 * ARCSEC), None, 1)
COVARIANCE = np.diag(np.tile([0.12 * 2e-6, 2e-5, 1e-7, 0.5 * ARCSEC, 0.5 * ARCSEC], 6)) ** 2
STILL, NOWHERE = np.zeros((6, 5)), np.zeros(3)
REFERENCE = block(unit_vectors(6, 3), STILL, COVARIANCE, NOWHERE)


def test_as_found_and_as_left_are_judged_with_the_tolerances_like_an_upload() -> None:
    """Two scales strayed by noise to either side, too little for a majority to call them moved within the tolerance."""
    change = STILL.copy()
    change[:2, 0] = 0.12 * 2e-6 * np.sqrt(2) * np.array([4.6, -4.6])
    now = block(unit_vectors(6, 3), change, COVARIANCE, NOWHERE)
    assert decisions_of(now, REFERENCE, KIND, 2.0) == judge(now, REFERENCE, KIND, 2.0).decisions


def test_a_block_turned_by_five_degrees_passes() -> None:
    turned = block(unit_vectors(6, 3), STILL, COVARIANCE, np.radians([3.0, 0.0, 4.0]))
    assert judge(turned, REFERENCE, KIND, 2.0).verdict is Verdict.PASS
