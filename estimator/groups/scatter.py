"""Noise of a session as its own residuals show it, where they contradict what is stated."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.remaining import remaining_of_sensors
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

ROUNDS = 20
"""Steps of a sensor's variance: each brings it half nearer at least."""

CLOSE = 0.01
"""Relative change of a variance below which it has settled: hundreds of readings tell it to some per cent."""


def with_residual_scatter(baseline: Baseline, groups: Sequence[Sequence[int]], named: Array | None) -> Baseline:
    """The baseline with the variance of some sensors that of their own residuals (restricted likelihood).

    Sensors of one group are off by one factor. ``named`` (R, m, q) are effects, any unit, that count as no noise. Step
    by step: a sensor that is believed too much pulls what all share of a row to its own readings.
    """
    variance = baseline.variance.copy()
    for _ in range(ROUNDS):
        energy, freedom = remaining_of_sensors(WhitenedResiduals.of(replace(baseline, variance=variance)), named)
        larger = np.array([energy[list(g)].sum() / max(freedom[list(g)].sum(), 1.0) for g in groups])
        for group, factor in zip(groups, larger, strict=True):
            variance[:, list(group)] *= factor
        if np.abs(np.log(larger)).max() < CLOSE:
            break
    return replace(baseline, variance=variance)
