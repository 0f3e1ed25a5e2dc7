"""Noise that the file does not state, estimated beside the effects that a first search finds.

Theory
------
The restricted likelihood of the baseline (`estimator.calibration.noise`) knows no effects, and the stand's errors by
their stated sigmas only. An eccentricity ten times as large leaves its residual in every sensor, and the estimated
noise takes it up: the sensors then seem as noisy as the stand is wrong. A name that removes the residual leaves that
noise far too large, and the row covariance D + H S H' the wrong shape: the scatter of β, which H S H' should hold,
stands out of what is left as structure of its own, and the true name is taken back for it. So the noise is estimated
again beside what a first search finds, its columns taken off with the parameters', until it no longer changes.
"""

from dataclasses import replace

import numpy as np

from estimator.diagnosis.residuals.fitted import with_expected_ratio
from estimator.diagnosis.residuals.refitted import refitted
from estimator.diagnosis.selection.forward import forward_selection
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.selection.start import restart_from, with_residual_scatter

SMALLER = 0.5
"""Variance over the one before below which the noise was inflated: that of sixteen readings is known to a third."""

ROUNDS = 3
"""A second effect shows once the noise is no longer inflated by the first."""


def with_noise_beside_effects(start: SearchState) -> SearchState:
    """The search begun with unstated noise as it is beside the effects; as it was where nothing is found, or the noise
    stays the same."""
    unstated = np.flatnonzero(start.baseline.unstated)
    for _ in range(ROUNDS if len(unstated) else 0):
        found = forward_selection(start).detections
        if not found:
            return start
        named = np.concatenate([f.best.shape.columns for f in found], axis=-1)
        scaled = with_residual_scatter(start.baseline, [[i] for i in unstated.tolist()], named)
        if np.min(scaled.variance[:, unstated] / start.baseline.variance[:, unstated]) > SMALLER:
            return start
        begun = restart_from(start, with_expected_ratio(refitted(scaled)))
        start = replace(begun, stated=np.where(start.baseline.unstated, scaled.variance, start.stated))
    return start
