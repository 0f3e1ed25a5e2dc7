"""Redundancy: an error of the applied vector leaves nothing in parity space; one sensor's fault leaves its share."""

import numpy as np
import pytest

from estimator.diagnosis import Finding
from tests.estimator.causes.hiding import found

STAND = ["beta-eccentricity", "axis-wobble", "stand-drift", "flip-misalignment", "levelling-y", "alpha-shift"]
SENSOR = ["cubic-nonlinearity", "bias-ramp", "scale-temperature"]


def finding_of(cause: str) -> Finding:
    """The finding of a hidden cause."""
    return next(f for f in found(cause).findings if f.cause == cause)


@pytest.mark.parametrize("cause", STAND)
def test_a_stand_error_leaves_nothing_in_parity_space(cause: str) -> None:
    split = finding_of(cause).parity
    assert split is not None
    assert split.signature_in_parity < 1e-6
    assert split.range_before - split.range_after > 20 * abs(split.parity_before - split.parity_after)


@pytest.mark.parametrize("cause", SENSOR)
def test_a_fault_of_one_sensor_of_six_leaves_half_its_energy_there(cause: str) -> None:
    split = finding_of(cause).parity
    assert split is not None
    assert abs(split.signature_in_parity - 0.5) < 0.01
    assert split.parity_before - split.parity_after > 400


def test_excess_noise_is_no_mean_effect() -> None:
    (finding,) = found("excess-noise").findings
    assert (finding.cause, finding.sensors) == ("excess-noise", ("A2",))
    assert abs(finding.amplitude[0] - 5 * 3e-6 / 0.12) < 4 * finding.sigma[0]


def test_warm_up_states_its_time_constant_and_what_it_costs() -> None:
    finding = finding_of("warm-up")
    assert 450 < finding.nonlinear["s"] < 1800
    assert 0.02 < finding.sigma[0] / abs(finding.amplitude[0]) < 0.5


def test_history_tells_what_is_new() -> None:
    (finding,) = found("sensor-drift").findings
    assert finding.sensors == ("A2",)
    assert np.count_nonzero(finding.amplitude) == 1
