"""The levels and the power behind what parity detects, attributes and judges."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.parity import probability_out
from estimator.parity import ParityAccumulator, ParityResult
from estimator.parity.blocks import select
from estimator.parity.hypotheses import Evidence, log_tail
from estimator.parity.regression import regress
from estimator.parity.results import Sight
from estimator.results import Calibration
from estimator.session import CalibrationSession
from tests.estimator.parity.cases import biased, block, recording


def given(size: float) -> tuple[CalibrationSession, Calibration]:
    """A flight of six sensors whose third zero has moved, m/s², and its reference."""
    true, reference = block(6)
    return recording(biased(true, 2, size), seconds=120.0), reference


def stream(size: float) -> ParityAccumulator:
    """That has taken the flight in."""
    flight, reference = given(size)
    made = ParityAccumulator("T-1", flight.sensors, reference, sample_rate=20.0, site=flight.site)
    made.add(flight.readings)
    return made


def evidence(size: float) -> Evidence:
    """Of the flight."""
    taken = stream(size)
    return Evidence(regress(select(taken.ledger, "auto"), taken.reference, 9.81))


def result(size: float, false_alarm: float = 0.01) -> ParityResult:
    """Of the flight."""
    return stream(size).result(false_alarm=false_alarm)


def test_half_of_the_false_alarms_is_for_all_numbers_and_half_for_the_best_hypothesis() -> None:
    found = evidence(1e-4)
    best = min(h.p_value for h in found.all) * 24
    least = min(best, found.p_value(found.chi2, 12))
    assert not found.detected(1.99 * least)
    assert found.detected(2.01 * least)


def test_the_detectable_bias_is_a_two_sided_student_quantile_and_the_power() -> None:
    found = evidence(0.0)
    bias = found.sensor(2, 0.01, []).bias
    assert bias.detectable is not None
    factor = stats.t.isf(0.01 / 2 / 24 / 2, found.dof) + stats.norm.isf(0.05)
    assert bias.detectable / (bias.sigma or 0) == pytest.approx(factor)


def test_the_probability_of_being_out_is_that_of_both_tails() -> None:
    sight = Sight((0.5,), ((1.0,),), None, None)
    assert probability_out(sight, 1.0) == pytest.approx(stats.norm.sf(0.5) + stats.norm.sf(1.5))


def test_the_probability_of_an_axis_being_out_is_noncentral_chi_square() -> None:
    sight = Sight((3.0, 4.0), ((1.0, 0.0), (0.0, 1.0)), None, None)
    draws = np.random.default_rng(1).normal([3.0, 4.0], 1.0, (400_000, 2))
    assert probability_out(sight, 6.0) == pytest.approx(np.mean(np.hypot(*draws.T) > 6.0), abs=0.003)


@pytest.mark.parametrize("k", [1, 2, 3, 4])
def test_the_closed_tail_is_that_of_chi_square(k: int) -> None:
    for x in (0.5, 3.0, 50.0):
        assert log_tail(x, k) == pytest.approx(stats.chi2.logsf(x, k))
