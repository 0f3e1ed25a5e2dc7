"""A name that rests on single readings does not hold where the errors have heavy tails; others do."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from estimator.causes import cause
from estimator.diagnosis.explanation.findings import notes
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.selection.heavy_tails import FREEDOMS, gained, scale_of, tails_of, without_names_of_tails
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.selection.start import begin
from estimator.session import Array
from estimator.simulate import simulate
from tests.estimator.calibration.cases import accelerometers, block
from tests.estimator.causes.hiding import with_readings
from tests.estimator.causes.worlds import truth_of, wandering
from tests.estimator.diagnosis.selection.small import SENSOR, candidate, names

SCHEDULE = wandering(block(accelerometers(6), 24))
ROWS, NOISE = len(SCHEDULE.readings), 1e-4
HEAVY = 3.0


def errors(freedom: float) -> Array:
    """(R, 6) standard errors: deviates of Student's t, one of every share, in an order drawn once."""
    shares = (np.arange(6 * ROWS) + 0.5) / (6 * ROWS)
    drawn = stats.t.ppf(shares, freedom)
    return np.random.default_rng(64).permutation(drawn / drawn.std()).reshape(ROWS, 6)


def searched(identifier: str, course: Array, freedom: float = np.inf) -> SearchState:
    """The state before the search for a cause, with a course (R,) of one sensor added, in standard errors."""
    still = simulate(SCHEDULE, truth_of(SCHEDULE), np.random.default_rng(1), noise=np.full(6, 1e-4 * NOISE))
    off = errors(freedom) + course[:, None] * np.eye(6)[SENSOR]
    session = replace(with_readings(still, NOISE * off), standard_errors=np.full((ROWS, 6), NOISE))
    return begin(baseline_of(session), (), [cause(identifier)])


def found(identifier: str, course: Array, freedom: float = np.inf) -> SearchState:
    """The state once the cause is named."""
    state = searched(identifier, course, freedom)
    return replace(state, detections=(candidate(state, identifier),))


SPIKE = 6.5 * (np.arange(ROWS) == 9)


def test_a_lone_reading_among_normal_errors_is_an_outlier() -> None:
    assert names(without_names_of_tails(found("reading-outlier", SPIKE))) == [("reading-outlier", (SENSOR,))]


def test_the_same_reading_among_heavy_tails_is_none_and_a_note_says_so() -> None:
    state = without_names_of_tails(found("reading-outlier", SPIKE, HEAVY))
    assert state.detections == ()
    assert "no cause" in notes(state)[0]


def test_what_many_readings_show_holds_in_heavy_tails() -> None:
    state = found("bias-ramp", np.linspace(-4, 4, ROWS), HEAVY)
    assert names(without_names_of_tails(state)) == [("bias-ramp", (SENSOR,))]


def test_tails_are_told_by_what_is_left() -> None:
    heavy, normal = (tails_of(searched("bias-ramp", np.zeros(ROWS), v)) for v in (HEAVY, np.inf))
    assert heavy is not None
    assert normal is not None
    assert heavy.weight[FREEDOMS <= 6.0].sum() > 0.9
    assert normal.weight[-1] > 0.95


def test_under_tails_a_lone_reading_gains_a_logarithm_only() -> None:
    own = np.eye(30)[:, :1]
    assert gained(9.0 * own[:, 0], own, np.ones(30, dtype=bool), (4.0, 0.8)) == pytest.approx(
        5 * np.log1p(81 / (4 * 0.64)), rel=1e-6
    )
    assert gained(9.0 * own[:, 0], own, np.ones(30, dtype=bool), (np.inf, 1.0)) == pytest.approx(81)


def test_the_scale_of_student_s_t_is_found() -> None:
    shares = (np.arange(2000) + 0.5) / 2000
    assert scale_of(2.5 * stats.t.ppf(shares, 4.0), 4.0) == pytest.approx(2.5, rel=0.02)
