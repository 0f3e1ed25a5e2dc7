"""A block that sits turned by degrees in its flipped run: the baseline is fitted about that turn.

The applied vectors of the flipped run are n = exp(−k×)·n0. Linear in k, a quarter of its square would be left in the
readings (16″ of 1°) and pass for other causes. So the baseline is fitted with the flipped run turned by a k0, which is
where everything is linear and no estimate: k0 goes back into the residuals as the effect that it is, and the turn is an
amplitude of the joint fit as before.
"""

from dataclasses import replace

import numpy as np

from estimator.causes.contract import Setting
from estimator.causes.fixture import FlipMisalignment
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.least_squares import FAINT, least_squares
from estimator.parameters import SensorParameters
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

SMALL = 1e-4
"""rad (20″) up to which a turn is taken as linear: a quarter of its square, 2.5e-9, is below any reading's noise."""
LARGEST = 0.2
"""rad (11°) beyond which the run was not merely seated badly: the record is wrong, and no place is better than none."""
ROUNDS = 6
"""Rounds of fits; two or three are usual."""


def flip_effect(setting: Setting) -> Array:
    """(R, m) m/s² (rad/s): what the turn of the flipped run that a setting holds adds at the input, to first order."""
    if setting.flipped is None or not setting.flip_turn.any():
        return np.zeros(setting.n.shape[:2])
    return setting.through(FlipMisalignment().change(setting)) @ setting.flip_turn


def with_its_flip(session: CalibrationSession) -> Baseline:
    """The baseline of a session, fitted about the turn of its flipped run where that is not small."""
    return with_fitted_flip(baseline_of(replace(session, flip_turn=np.zeros(3))))


def with_fitted_flip(baseline: Baseline, start: SensorParameters | None = None) -> Baseline:
    """A fitted session's baseline, fitted again about its turn from the same ``start``, with no turn to begin with."""
    session, cause = baseline.session, FlipMisalignment()
    if session.programme != TWO_AXIS_STAND or not cause.available(baseline.setting):
        return baseline
    for _ in range(ROUNDS):
        residuals = WhitenedResiduals.of(baseline)
        trace = residuals.trace(baseline.setting.through(cause.change(baseline.setting)))
        turn = least_squares(trace, residuals.z, FAINT).value
        difference = np.linalg.norm(turn - baseline.session.flip_turn)
        if difference < SMALL or np.linalg.norm(turn) > LARGEST:
            break
        baseline = baseline_of(replace(session, flip_turn=turn), start)
        baseline = replace(baseline, residual=baseline.residual + flip_effect(baseline.setting))
    return baseline
