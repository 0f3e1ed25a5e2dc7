"""Effects that lasted since the history, that are new, and such that leave the sensor's own change open."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import CalibrationSession
from estimator.causes import Signature, cause
from estimator.diagnosis.residuals.between_sessions import parameter_change
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.lasting import absorbed_before, traces_of
from estimator.diagnosis.signatures.traces import Traces
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene, with_readings

WHERE = scene(ACCELEROMETER, 2)
NOW = baseline_of(WHERE.measured(1))
CHANGE = parameter_change(NOW, [baseline_of(h) for h in WHERE.earlier(1)])
RESIDUALS = WhitenedResiduals.of(NOW, CHANGE)


def hypotheses(identifier: str) -> list[Traces]:
    """The traces of one cause with history."""
    known = cause(identifier)
    assert isinstance(known, Signature)
    return traces_of(RESIDUALS, [known])


def moved(traces: Traces) -> np.ndarray:
    """(S,) norm of what a unit amplitude moves of the parameters, standard errors."""
    return np.linalg.norm(traces.columns[:, RESIDUALS.rows :, 0], axis=1)


def signature(identifier: str) -> Signature:
    """A cause of the catalogue that has one."""
    found = cause(identifier)
    assert isinstance(found, Signature)
    return found


def test_a_sensor_s_cause_is_tried_as_lasting_as_new_and_with_its_change_left_open() -> None:
    lasting, new, open_change = hypotheses("bias-temperature")
    assert (set(lasting.lasting), set(new.lasting)) == ({True}, {False})
    assert open_change.width == lasting.width + 5


def test_what_lasted_moves_less_than_what_is_new() -> None:
    lasting, new, _ = hypotheses("bias-temperature")
    assert np.all(moved(lasting) < 1e-4 * moved(new)), "this session has the schedule of its history"


def test_an_open_change_spans_every_change_of_its_sensor_and_of_no_other() -> None:
    *_, open_change = hypotheses("bias-temperature")
    step = np.zeros(30)
    step[5 * 2 : 5 * 2 + 5] = 1e-5
    own = open_change.whole(2)[1][RESIDUALS.rows :, 1:]
    assert np.allclose(own @ np.full(5, 1e-5), CHANGE.inverse_root @ step)


def test_an_open_change_is_no_amplitude() -> None:
    *_, open_change = hypotheses("bias-temperature")
    assert np.all(open_change.raw[:, 1:] == 0)
    assert np.all(open_change.raw[:, 0] > 0)


def test_a_common_cause_is_lasting_or_new() -> None:
    assert [set(t.lasting) for t in hypotheses("beta-eccentricity")] == [{True}, {False}]


def test_a_change_since_the_history_is_new_by_its_nature() -> None:
    assert [set(t.lasting) for t in hypotheses("remount-rotation")] == [{False}]


def test_without_history_there_is_one_hypothesis_and_no_change_to_explain() -> None:
    alone = WhitenedResiduals.of(NOW)
    assert len(traces_of(alone, [cause("bias-temperature")])) == 1
    assert traces_of(alone, [cause("remount-rotation")]) == []


def test_what_acts_from_some_row_on_is_not_foretold_in_other_sessions() -> None:
    jump = signature("bias-jump")
    assert absorbed_before(RESIDUALS, jump, [next(jump.shapes(NOW.setting))]) is None


def reordered(session: CalibrationSession, rows: np.ndarray) -> CalibrationSession:
    """The session with its positions measured in another order, at the same moments."""
    return replace(
        session,
        readings=session.readings[rows],
        standard_errors=session.standard_errors[rows],
        beta=session.beta[rows],
        flipped=session.flipped[rows],
    )


def test_a_lasting_effect_that_another_schedule_absorbed_otherwise_is_foretold() -> None:
    """A ramp passes for a tilt of the axis in order around the circle, but not in a random order."""
    plain = WHERE.measured(1)
    around = np.lexsort((plain.beta, plain.flipped))
    ramp = signature("bias-ramp")
    added = 0.12 * 3e-6 * (plain.time - plain.time.mean())[:, None] * np.eye(6)[2]
    now = baseline_of(with_readings(reordered(plain, around), added))
    past = [baseline_of(with_readings(h, added)) for h in WHERE.earlier(1)]
    change = parameter_change(now, past)
    residuals = WhitenedResiduals.of(now, change)
    (shape,) = [s for s in ramp.shapes(now.setting) if s.sensors == (2,)]
    foretold = residuals.trace(shape.columns, absorbed_before(residuals, ramp, [shape]))[residuals.rows :, 0] * 3e-6
    assert np.linalg.norm(change.deviation) > 30
    assert np.linalg.norm(change.deviation - foretold) < 3 * np.sqrt(len(foretold))


@pytest.mark.parametrize("identifier", ["bias-temperature", "cubic-nonlinearity"])
def test_what_the_history_absorbed_is_the_sum_over_its_sessions(identifier: str) -> None:
    """The sessions are at other temperatures each; those in which the cause is the same signature are worked out
    together.
    """
    known, settings = signature(identifier), [one.setting for one in CHANGE.earlier]
    warmer = [replace(s, temperature=(k + 1) * s.temperature) for k, s in enumerate(settings)]
    earlier = [replace(one, setting=s) for one, s in zip(CHANGE.earlier, warmer, strict=True)]
    shapes = list(known.shapes(NOW.setting))
    whole, *each = (
        absorbed_before(replace(RESIDUALS, change=replace(CHANGE, earlier=own)), known, shapes)
        for own in (earlier, *([one] for one in earlier))
    )
    assert np.allclose(whole, sum(each), rtol=0, atol=1e-12 * np.abs(whole).max())
