"""A stored calibration comes back as it was computed."""

import json

import numpy as np
import pytest

from estimator import calibrate
from estimator.reading import read_session
from estimator.results import Calibration
from tests.builders import Document, accelerometer_block, gyro_block


@pytest.mark.parametrize("document", [accelerometer_block(), gyro_block(), accelerometer_block(runs=("direct",))])
def test_there_and_back(document: Document) -> None:
    before = calibrate(read_session(document))
    after = Calibration.from_dict(json.loads(json.dumps(before.to_dict(), allow_nan=False)))
    assert after.to_dict() == before.to_dict()
    np.testing.assert_array_equal(after.covariance, before.covariance)
    np.testing.assert_array_equal(after.residuals.value, before.residuals.value)
