"""Unknown orientations, no stated noise, one sensor noisier than the others: no cause, no structure."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import diagnose
from tests.estimator.calibration.free_sessions import session, sphere, truth

NOISE = 1e-4
"""m/s²."""


def is_called_wrong(factor: float, seed: int) -> bool:
    """Whether a block of six, one sensor ``factor`` times as noisy, gets a name other than noise, or structure."""
    rng, true, noise = np.random.default_rng([9, seed]), truth(6, seed=seed), np.full(6, NOISE)
    noise[seed % 6] *= factor
    quiet = session(true, sphere(12, rng), noise=0.0, stated=False, rng=rng)
    noisy = quiet.readings + true.scale * noise * rng.standard_normal((12, 6))
    found = diagnose(replace(quiet, readings=noisy, time=60.0 * np.arange(12)))
    return found.unexplained or any(f.cause != "excess-noise" for f in found.findings)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [3.5, 5.0])
def test_white_noise_of_unequal_sensors_is_no_structure(factor: float) -> None:
    assert not any(is_called_wrong(factor, seed) for seed in range(8))


@pytest.mark.slow
@pytest.mark.parametrize("factor", [3.5, 5.0])
def test_one_sensor_noisier_than_stated_is_called_noisy(factor: float) -> None:
    """With 24 orientations the noisy sensor's readings pull the directions that all share, so that others scatter
    too.
    """
    for seed in range(4):
        rng, true, noise = np.random.default_rng([10, seed]), truth(6, seed=seed), np.full(6, NOISE)
        noise[seed] *= factor
        quiet = session(true, sphere(24, rng), noise=0.0, stated=False, rng=rng)
        noisy = quiet.readings + true.scale * noise * rng.standard_normal((24, 6))
        errors = np.broadcast_to(NOISE * np.abs(true.scale), noisy.shape)
        found = diagnose(replace(quiet, readings=noisy, standard_errors=errors, time=60.0 * np.arange(24)))
        assert [(f.cause, f.sensors) for f in found.findings] == [("excess-noise", (quiet.sensors[seed].name,))]
