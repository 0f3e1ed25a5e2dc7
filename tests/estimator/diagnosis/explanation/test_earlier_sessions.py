"""Amplitudes found in one session are held against the latest earlier one, where the effect can have acted too."""

import numpy as np
import pytest

from estimator import CalibrationSession, diagnose
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import change, scene, with_readings

WHERE = scene(ACCELEROMETER, 2)


def with_cause(session: CalibrationSession, cause: str) -> CalibrationSession:
    return with_readings(session, change(cause, WHERE) * WHERE.world.truth.scale)


@pytest.mark.slow
@pytest.mark.parametrize("cause", ["bias-temperature", "hysteresis", "beta-second-harmonic"])
def test_a_lasting_cause_predicts_the_earlier_session_too(cause: str) -> None:
    earlier = [with_cause(h, cause) for h in WHERE.earlier(3)]
    found = diagnose(with_cause(WHERE.measured(3), cause), history=earlier)
    assert (found.findings[0].cause, found.findings[0].new) == (cause, False)
    on = found.gain.session
    assert on is not None
    assert on.before.chi2_per_dof > 1.3 > on.after.chi2_per_dof
    assert on.after.log_score > on.before.log_score
    assert on.after.rms < on.before.rms


def test_a_cause_that_came_since_is_not_held_against_the_past() -> None:
    found = diagnose(with_cause(WHERE.measured(3), "hysteresis"), history=WHERE.earlier(3))
    assert (found.findings[0].cause, found.findings[0].new) == ("hysteresis", True)
    assert found.gain.session is None


def test_without_history_there_is_no_other_session_and_nothing_is_called_new() -> None:
    found = diagnose(with_cause(WHERE.measured(3), "hysteresis"))
    assert (found.findings[0].cause, found.findings[0].new) == ("hysteresis", None)
    assert found.gain.session is None


@pytest.mark.slow
def test_the_score_of_the_other_session_knows_the_amplitudes_uncertainty() -> None:
    """χ² per degree of freedom of what the amplitude predicts stays near one over many sessions."""
    shares = []
    for seed in range(4, 10):
        earlier = [with_cause(h, "hysteresis") for h in WHERE.earlier(seed)]
        on = diagnose(with_cause(WHERE.measured(seed), "hysteresis"), history=earlier).gain.session
        shares.append(on.after.chi2_per_dof if on else np.nan)
    assert abs(np.mean(shares) - 1) < 0.15
