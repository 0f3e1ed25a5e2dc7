"""A baseline fitted anew under other noise stays where its history can be compared with it."""

from dataclasses import replace

import numpy as np
import pytest

from benchmarks.study.turned_pairs import PROGRAMMES, draw_flipped
from estimator import read_session
from estimator.diagnosis.residuals.baseline import turn_response
from estimator.diagnosis.residuals.between_sessions import deviation
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.flipped_run import with_its_flip
from estimator.diagnosis.residuals.refitted import refitted
from tests.blind.cases import draw_case
from tests.estimator.calibration.cases import CASES

(ARBITRARY,) = [case for case in CASES if case.name == "arbitrary-orientations"]


def test_a_refit_in_arbitrary_orientations_turns_no_axes_in_common() -> None:
    (session,) = ARBITRARY.simulated(1)
    before = baseline_of(session)
    after = refitted(replace(before, variance=before.variance * [1.0, 4.0, 0.25, 9.0]))
    step = deviation(before.parameters, after.parameters, before.setting.norm).reshape(-1)
    turn = np.linalg.lstsq(turn_response(before.parameters), step, rcond=None)[0]
    assert np.abs(step).max() > 1e-8
    assert turn == pytest.approx(np.zeros(3), abs=1e-12)


def test_a_refit_under_the_same_noise_leaves_a_block_turned_in_its_flipped_run_as_it_is() -> None:
    """The turn stays in the residuals: taken up by the parameters too, it would count twice beside a history."""
    before = with_its_flip(read_session(draw_flipped(PROGRAMMES[1], 1.0, np.random.default_rng(16)).session))
    assert before.setting.flip_turn.any()
    step = deviation(before.parameters, refitted(before).parameters, before.setting.norm)
    assert np.abs(step).max() < 1e-8


def test_a_refit_leaves_what_the_readings_do_not_tell_where_it_was() -> None:
    """The last sensor lies along the head's axis: its scale and its zero are told only together."""
    before = baseline_of(read_session(draw_case("none", (4001, 28, 3, 0, 1)).session))
    after = refitted(replace(before, variance=before.variance * [36.0, 1.0, 1.0, 1.0, 1.0, 1.0]))
    step = deviation(before.parameters, after.parameters, before.setting.norm)
    assert 1e-9 < np.abs(step[:-1]).max() < 1e-5
    assert np.abs(step[-1]).max() < 0.01
