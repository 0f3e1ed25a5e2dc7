"""A block that sits turned by degrees in its flipped run: the baseline is fitted about that turn."""

import numpy as np
import pytest

from benchmarks.study.turned_pairs import PROGRAMMES, Pair, draw_flipped
from estimator import calibrate, diagnose, read_session
from estimator.causes.fixture import FlipMisalignment
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.flipped_run import with_its_flip
from estimator.diagnosis.residuals.whitened import WhitenedResiduals


def drawn(degrees: float) -> Pair:
    """Six accelerometers, simulated apart from the estimator."""
    return draw_flipped(PROGRAMMES[1], degrees, np.random.default_rng([16, 1]))


def test_a_small_turn_leaves_the_baseline_as_it_is() -> None:
    session = read_session(drawn(0.003).session)
    assert with_its_flip(session).residual == pytest.approx(baseline_of(session).residual, abs=0)


def test_a_large_turn_leaves_nothing_but_itself() -> None:
    """A first-order model would leave 8 % of the turn: thousands of standard errors of 5 degrees."""
    found = with_its_flip(read_session(drawn(5.0).session))
    residuals = WhitenedResiduals.of(found)
    trace = residuals.trace(found.setting.through(FlipMisalignment().change(found.setting)))
    left = residuals.z - trace @ np.linalg.lstsq(trace, residuals.z, rcond=1e-6)[0]
    assert left @ left < residuals.freedom + 5 * np.sqrt(2 * residuals.freedom)


def test_the_extended_calibration_is_that_of_a_block_seated_well() -> None:
    turned, straight = (read_session(drawn(degrees).session) for degrees in (5.0, 0.0))
    found, expected = diagnose(turned).calibration, calibrate(straight)
    for one, other in zip(found.sensors, expected.sensors, strict=True):
        assert one.axis == pytest.approx(other.axis, abs=6 * one.axis_sigma)
        assert one.scale.value == pytest.approx(other.scale.value, abs=6 * one.scale.sigma)
