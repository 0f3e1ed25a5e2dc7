"""Places of patterns without a name, in words."""

import numpy as np
import pytest

from estimator.causes.contract import Shape
from estimator.diagnosis.signatures.patterns import CommonPeriodic, Pattern, SensorPeriodic


@pytest.mark.parametrize(
    ("periods", "said"), [(1.0, "a wave of one period over"), (1.5, "a wave of 1.5 periods over"), (3.0, "3 periods")]
)
@pytest.mark.parametrize("pattern", [SensorPeriodic(), CommonPeriodic()])
def test_a_wave_of_one_period_is_told_as_one(pattern: Pattern, periods: float, said: str) -> None:
    assert said in pattern.where(Shape((0,), np.zeros((4, 1, 2)), (periods,)))
