"""The levels and the power behind what parity detects, attributes and judges."""

import numpy as np
import pytest
from scipy import stats

from estimator.health.parity import probability_out
from estimator.parity import ParityAccumulator, parity_check
from estimator.parity.blocks import select
from estimator.parity.hypotheses import ParityEvidence
from estimator.parity.isolation import log_tail
from estimator.parity.reference import reference_of
from estimator.parity.regression import regress
from estimator.parity.results import Sight
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, CalibrationSession
from tests.estimator.parity.cases import biased, block, recording, scaled


def given(size: float) -> tuple[CalibrationSession, Calibration]:
    """A flight of six sensors whose third zero has moved, m/s², and its reference."""
    true, reference = block(6)
    return recording(biased(true, 2, size), seconds=120.0), reference


def stream(size: float) -> ParityAccumulator:
    """An accumulator that has taken the flight in."""
    flight, reference = given(size)
    made = ParityAccumulator("T-1", flight.sensors, reference, sample_rate=20.0, site=flight.site)
    made.add(flight.readings)
    return made


def evidence(size: float) -> ParityEvidence:
    """Evidence of the flight."""
    taken = stream(size)
    return ParityEvidence(regress(select(taken.ledger, "auto"), taken.reference, 9.81))


def test_half_of_the_false_alarms_is_for_all_numbers_and_half_for_the_best_hypothesis() -> None:
    found = evidence(1e-4)
    best = min(h.p_value for h in found.all) * 24
    least = min(best, found.p_value(found.chi2, 12))
    assert not found.detected(1.99 * least)
    assert found.detected(2.01 * least)


def test_the_detectable_bias_is_a_two_sided_student_quantile_and_the_power() -> None:
    """The quantile is in units of a sigma that is itself known to 1/sqrt(2 dof), which widens what is missed."""
    found = evidence(0.0)
    bias = found.sensor(2, 0.01, []).bias
    assert bias.detectable is not None
    quantile = stats.t.isf(0.01 / 2 / 24 / 2, found.dof)
    factor = quantile + stats.norm.isf(0.05) * np.sqrt(1 + quantile**2 / (2 * found.dof))
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


def test_the_regression_is_that_of_least_squares() -> None:
    """All blocks are equally long here, so that their weights are one."""
    taken = stream(0.0)
    chosen = select(taken.ledger, "auto")
    found = regress(chosen, taken.reference, 9.81)
    n = taken.reference.vector(chosen.blocks.mean)
    z = np.column_stack([np.ones(len(n)), n / 9.81]) @ found.excited
    assert found.theta == pytest.approx(np.linalg.lstsq(z, chosen.blocks.mean @ taken.reference.parity)[0])
    assert pytest.approx(np.linalg.lstsq(z, (n @ taken.reference.axes.T) ** 2)[0]) == found.quadratic.T


def test_a_bias_shows_as_the_constant_of_its_sensor_in_parity_space() -> None:
    taken = stream(5e-3)
    assert taken.result().constant == pytest.approx(5e-3 * taken.reference.parity[2], abs=2e-4)


def test_a_scale_shows_as_the_slope_of_its_sensor_in_parity_space() -> None:
    true, calibration = block(6)
    flight = recording(scaled(true, 2, 3e-3), seconds=120.0)
    reference = reference_of(flight.sensors, calibration, ACCELEROMETER)
    expected = 3e-3 * np.outer(reference.parity[2], reference.axes[2])
    assert parity_check(flight, calibration).slope == pytest.approx(expected, abs=1e-4)
