"""Readings that switch between levels from row to row, told from noise of whatever size."""

import numpy as np
import pytest

from estimator import diagnose
from estimator.causes import CATALOGUE
from estimator.diagnosis.signatures.switching import likeliest_states
from estimator.session import Array
from tests.estimator.causes.hiding import scene_for, spoilt

RNG = np.random.default_rng(8)
ROWS = 24
WAVES = np.outer(np.arange(ROWS), np.array([0.0, 0.26, 0.3, 0.52, 0.6])) + np.array([1.6, 0.0, 1.0, 0.0, 1.0])
ABSORBED = np.linalg.qr(np.sin(WAVES))[0]
FREE = np.eye(ROWS) - ABSORBED @ ABSORBED.T
ROOT = np.linalg.svd(FREE)[0][:, : ROWS - 5]
"""Directions that a calibration of five parameters leaves of 24 readings."""


def told_of(readings: Array, least: float = 1.0) -> tuple[float, Array]:
    """Evidence and likeliest states of readings (R,), in standard errors, beside what the calibration absorbs."""
    return likeliest_states(ROOT, ROOT.T @ readings, ABSORBED, least)


def switched(seed: int) -> tuple[Array, Array]:
    """Readings that switch, in standard errors, and the states."""
    rng = np.random.default_rng(seed)
    states = np.sign(rng.standard_normal(ROWS))
    return 8 * states + rng.standard_normal(ROWS), states


@pytest.mark.slow
@pytest.mark.parametrize("least", [0.0, 1.0])
def test_noise_reaches_no_more_evidence_than_chance_allows(least: float) -> None:
    drawn = [told_of(6 * RNG.standard_normal(ROWS), least)[0] for _ in range(300)]
    assert np.mean(np.array(drawn) > np.log(20)) < 0.01


def test_the_states_are_those_that_were_there() -> None:
    readings, states = switched(2)
    weight, told = told_of(readings)
    assert weight > 10
    assert abs(told @ states) == ROWS


def test_a_sequence_that_the_calibration_absorbs_almost_wholly_is_told_too() -> None:
    states = np.sign(ABSORBED[:, 3])
    weight, told = told_of(30 * states + RNG.standard_normal(ROWS))
    assert weight > 10
    assert abs(told @ states) == ROWS


def test_a_row_between_the_levels_costs_little() -> None:
    readings, states = switched(2)
    whole, (weight, told) = told_of(readings)[0], told_of(readings - 8 * states * (np.arange(ROWS) == 3))
    assert whole > weight > whole - 5
    assert told[3] == 0


def test_a_lag_that_no_catalogue_has_is_switching_and_no_noise() -> None:
    where = scene_for("hysteresis")
    session = spoilt("hysteresis", where.measured(3), where, np.random.default_rng(1))
    told = diagnose(session, catalogue=[c for c in CATALOGUE if c.identifier != "hysteresis"])
    assert told.findings == ()
    assert told.unexplained
