"""Unknown orientations with few readings: what is said of the noise, and what is not."""

import json
from dataclasses import replace

import numpy as np
import pytest

from estimator.calibration import calibrate
from estimator.results import Calibration
from tests.estimator.calibration.cases import CASES, accelerometers, block
from tests.estimator.calibration.free_sessions import Truth, session, sphere, truth

NOISE = 1e-3
"""m/s²."""


def measured(m: int, count: int, seed: int, **changes: object) -> tuple[Calibration, Truth]:
    """One session of random orientations, without stated noise unless changed, and its truth."""
    rng, true = np.random.default_rng([seed, m, count]), truth(m, seed=seed)
    return calibrate(session(true, sphere(count, rng), rng=rng, **{"noise": NOISE, "stated": False, **changes})), true


def hits(result: Calibration, true: Truth, k: float = 1.959964) -> list[bool]:
    """Whether the interval of each scale, bias and axis turn covers the truth."""
    found = []
    for i, sensor in enumerate(result.sensors):
        for estimate, value in ((sensor.scale, true.scale[i]), (sensor.bias, true.bias[i])):
            if estimate.sigma is not None:
                found.append(abs(estimate.value - value) < estimate.factor(k) * estimate.sigma)
        if sensor.axis is None:
            continue
        turn = sensor.axis_tangents.T @ (true.axes[i] - sensor.axis)
        found += list(np.abs(turn) < sensor.factor("axis", k) * np.sqrt(np.diag(sensor.axis_covariance)))
    return found


def test_without_a_degree_of_freedom_no_uncertainty_is_claimed() -> None:
    result, _ = measured(3, 9, 1)
    assert result.fit.dof == 0
    assert np.isnan(result.covariance).all()
    assert {s.bias.sigma for s in result.sensors} | {s.axis_sigma for s in result.sensors} == {None}


def test_without_a_degree_of_freedom_there_are_values_still() -> None:
    result, true = measured(3, 9, 1, noise=1e-6)
    assert [s.bias.value for s in result.sensors] == pytest.approx(true.bias, abs=1e-4)
    assert all(s.observable["bias"] for s in result.sensors)


def test_it_is_said_how_many_positions_to_add() -> None:
    assert measured(3, 9, 1)[0].fit.positions_to_add == 5
    assert measured(3, 14, 1)[0].fit.positions_to_add == 0


def test_what_is_not_known_is_null_in_json() -> None:
    document = json.loads(json.dumps(measured(3, 9, 1)[0].to_dict(), allow_nan=False))
    first = document["sensors"][0]
    assert first["bias"]["sigma"] is first["bias"]["coverage_factor"] is first["axis"]["sigma_arcsec"] is None
    assert document["residuals"]["sigma"][0] == [None] * 3


def test_a_stand_session_without_a_degree_of_freedom_claims_none_either() -> None:
    case = replace(CASES[0], schedule=block(accelerometers(3), 8), noise=np.full(3, 3e-5))
    whole, rows = case.simulated(1)[0], [0, 2, 4, 9, 13]
    few = replace(
        whole, readings=whole.readings[rows], standard_errors=np.full((5, 3), np.nan),
        beta=whole.beta[rows], flipped=whole.flipped[rows],
        time=None, temperature=None,
    )  # fmt: skip
    result = calibrate(few)
    assert result.fit.dof == 0
    assert result.sensors[0].scale.sigma is None
    assert result.fit.positions_to_add == 2, "three sensors of one noise tell six degrees of freedom"


@pytest.mark.slow
@pytest.mark.parametrize(("m", "count"), [(3, 10), (3, 12), (3, 15), (4, 9), (3, 19)])
def test_intervals_hold_with_few_degrees_of_freedom(m: int, count: int) -> None:
    """40 sessions; parameters of one session go together, so each counts once."""
    shares = [np.mean(found) for seed in range(40) if (found := hits(*measured(m, count, seed)))]
    assert abs(np.mean(shares) - 0.95) < 0.01 + 2.5 * np.std(shares) / np.sqrt(len(shares))


@pytest.mark.slow
def test_a_noisy_sensor_has_a_noise_of_its_own() -> None:
    """Six sensors, one five times as noisy, 27 degrees of freedom together."""
    ratios = []
    for seed in range(30):
        rng, true = np.random.default_rng(seed), truth(6, seed=seed)
        noise = NOISE * np.array([5, 1, 1, 1, 1, 1])
        plain = session(true, sphere(12, rng), noise=0.0, stated=False)
        noisy = plain.readings + true.scale * noise * rng.standard_normal((12, 6))
        found = calibrate(replace(plain, readings=noisy)).residuals.sigma[0]
        ratios.append(found[0] / np.median(found[1:]))
    assert np.exp(np.mean(np.log(ratios))) == pytest.approx(5.0, rel=0.25)


def test_a_quadratic_term_never_takes_the_last_degrees_of_freedom() -> None:
    for seed in range(10):
        result, _ = measured(3, 12, seed)
        assert result.fit.dof == 3
        assert not result.sensors[0].observable["quadratic"]


@pytest.mark.parametrize("seed", [1, 46, 51, 141, 191])
def test_a_far_minimum_is_no_quadratic_term(seed: int) -> None:
    """Sessions in which the terms are many of their standard errors from zero, and χ² is hardly lower."""
    result, true = measured(4, 9, seed, stated=True)
    assert not result.sensors[0].observable["quadratic"]
    assert [s.bias.value for s in result.sensors] == pytest.approx(true.bias, abs=0.05)


def test_a_true_quadratic_term_is_estimated_without_stated_noise() -> None:
    rng, true = np.random.default_rng(3), truth(6, seed=3, quadratic=3e-4)
    result = calibrate(session(true, sphere(14, rng), noise=NOISE, stated=False, rng=rng))
    assert [s.quadratic.value for s in result.sensors] == pytest.approx(true.quadratic, abs=6e-5)
