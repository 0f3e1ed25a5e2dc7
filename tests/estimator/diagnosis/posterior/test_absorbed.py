"""What earlier sessions absorbed of an effect that has acted since before them."""

from dataclasses import replace

import numpy as np
import pytest

from estimator import CalibrationSession
from estimator.causes import cause
from estimator.causes.contract import SensorCause
from estimator.diagnosis.posterior.absorbed import absorbed_before
from estimator.diagnosis.residuals.between_sessions import parameter_change
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import ACCELEROMETER
from tests.estimator.causes.hiding import scene, with_readings

WHERE = scene(ACCELEROMETER, 2)
NOW = baseline_of(WHERE.measured(1))
CHANGE = parameter_change(NOW, [baseline_of(h) for h in WHERE.earlier(1)])
RESIDUALS = WhitenedResiduals.of(NOW, CHANGE)


def signature(identifier: str) -> SensorCause:
    """A cause of the catalogue that acts on one sensor."""
    found = cause(identifier)
    assert isinstance(found, SensorCause)
    return found


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
