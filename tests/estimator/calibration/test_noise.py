"""Noise that a file does not state, or understates."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from estimator import calibrate, calibrate_many
from estimator.calibration.stand import solved
from estimator.session import CalibrationSession
from estimator.simulate import simulate
from tests.estimator.calibration.cases import CASES, Case, accelerometers, block, errors

STAND, GYRO = CASES[0], CASES[3]


def sessions(case: Case, count: int, *, noise: float = 1.0, stated: bool = True) -> list[CalibrationSession]:
    """Sessions whose noise is ``noise`` times the case's own, stated or not."""
    rng = np.random.default_rng(4)
    return [
        simulate(case.schedule, case.truth, rng, noise=noise * case.noise, state_noise=stated) for _ in range(count)
    ]


@pytest.mark.slow
@pytest.mark.parametrize("case", [STAND, GYRO], ids=lambda c: c.name)
def test_unstated_noise_gives_honest_intervals(case: Case) -> None:
    results = calibrate_many(sessions(case, 600, stated=False))
    scaled = np.stack([errors(r, case.truth) / np.sqrt(np.diagonal(r.covariance)) for r in results])
    assert 0.93 <= np.mean(np.abs(scaled) < 1.96) <= 0.97


QUIET = replace(
    STAND,
    name="far quieter than the stand",
    schedule=block(accelerometers(bias_repeatability=0.0), 8),
    noise=np.full(6, 3e-6),
)
"""Noise a twentieth of what the stand's errors do to a reading."""


def found_noise(sessions: Sequence[CalibrationSession]) -> np.ndarray:
    """(S, m) sigma of a reading that the calibration took, over the true one."""
    return np.stack([np.sqrt(solved([s]).fitted.variance[0, 0]) for s in sessions]) * 0.12 / QUIET.noise


@pytest.mark.slow
def test_noise_far_below_the_errors_of_the_stand_gives_honest_intervals() -> None:
    results = calibrate_many(sessions(QUIET, 600, stated=False))
    scaled = np.stack([errors(r, QUIET.truth) / np.sqrt(np.diagonal(r.covariance)) for r in results])
    assert 0.93 <= np.mean(np.abs(scaled) < 1.96) <= 0.97


def test_noise_far_below_the_errors_of_the_stand_is_found() -> None:
    ratio = found_noise(sessions(QUIET, 100, stated=False))
    assert abs(np.exp(np.log(ratio).mean()) - 1) < 0.05
    assert np.quantile(ratio, [0.01, 0.99]) == pytest.approx([0.7, 1.3], abs=0.15)


def test_a_sensor_noisier_than_the_others_is_found_noisier() -> None:
    loud = replace(QUIET, noise=QUIET.noise * np.array([1, 1, 5, 1, 1, 1]))
    ratio = found_noise(sessions(loud, 100, stated=False)).mean(axis=0)
    assert ratio[2] == pytest.approx(5.0, rel=0.2)
    assert np.delete(ratio, 2) == pytest.approx(np.ones(5), rel=0.1)


def test_unstated_noise_is_called_estimated_and_not_judged() -> None:
    fit = calibrate(sessions(STAND, 1, stated=False)[0]).fit
    assert fit.noise == "estimated"
    assert fit.p_value is None
    assert fit.covariance_factor == 1.0


def test_one_sensor_without_stated_noise_is_enough_to_be_called_estimated() -> None:
    session = sessions(STAND, 1)[0]
    some = session.standard_errors.copy()
    some[:, 2] = np.nan
    assert calibrate(replace(session, standard_errors=some)).fit.noise == "estimated"


def test_understated_noise_enlarges_the_covariance() -> None:
    honest = sessions(STAND, 300, noise=4.0)
    modest = [replace(s, standard_errors=s.standard_errors / 4) for s in honest]
    results = calibrate_many(modest)
    assert all(r.fit.p_value < 1e-3 for r in results)
    assert np.mean([r.fit.covariance_factor for r in results]) > 2
    scaled = np.stack([errors(r, STAND.truth) / np.sqrt(np.diagonal(r.covariance)) for r in results])
    assert np.mean(np.abs(scaled) < 1.96) >= 0.92


def test_enlarging_leaves_the_estimate_and_the_standing_errors_of_the_stand() -> None:
    session = sessions(STAND, 1, noise=4.0)[0]
    right, enlarged = calibrate(session), calibrate(replace(session, standard_errors=session.standard_errors / 4))
    standing = np.diagonal(enlarged.covariance - enlarged.repeatability)
    assert np.allclose(standing, np.diagonal(right.covariance - right.repeatability), rtol=0.2)
    assert np.diagonal(enlarged.repeatability) == pytest.approx(np.diagonal(right.repeatability), rel=0.5)


def test_few_readings_share_one_noise() -> None:
    case = CASES[1]
    rows = np.r_[0:5, 12:16]
    few = [
        replace(
            s,
            readings=s.readings[rows],
            standard_errors=s.standard_errors[rows],
            beta=s.beta[rows],
            time=None,
            flipped=s.flipped[rows],
        )
        for s in sessions(case, 500, stated=False)
    ]
    scaled = np.stack([errors(r, case.truth) / np.sqrt(np.diagonal(r.covariance)) for r in calibrate_many(few)])
    assert 0.90 <= np.mean(np.abs(scaled) < 1.96) <= 0.97


def test_a_standard_error_of_zero_is_not_believed_beyond_rounding() -> None:
    session = sessions(STAND, 1, noise=0.0)[0]
    sensors = tuple(replace(s, bias_repeatability=0.0) for s in session.sensors)
    result = calibrate(replace(session, sensors=sensors))
    assert np.isfinite(result.covariance).all()
    assert all(all(s.observable.values()) for s in result.sensors)


def test_unstated_noise_is_that_of_the_session_whichever_others_are_solved_with_it() -> None:
    every = sessions(STAND, 8, stated=False)
    alone = [solved([one]).fitted.variance[0] for one in every]
    assert np.allclose(solved(every).fitted.variance, alone, rtol=1e-9, atol=0)
