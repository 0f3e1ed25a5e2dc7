"""Zeros that wander, every one of a kind of sensor by itself and all by as much: walks, or rates that walk.

Where all sensors drift, each in its own way, there is always some course that explains much of several: this is its
rival, one misfortune too.
"""

from collections.abc import Iterator

import numpy as np

from estimator.causes.shared import KINDS
from estimator.diagnosis.posterior.blocks import ColumnBlocks, TermColumns
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import SPREADS, WANDERING
from estimator.diagnosis.posterior.term import COURSE, UnknownCourse
from estimator.diagnosis.residuals.whitened import WhitenedResiduals

LEADING = 144
"""Waves of all wandering zeros together: twelve hold 97 % of a walk, fewer are enough where many sensors show it."""

FEWEST = 2
"""Waves of one zero at least."""


class WanderingZeros(ColumnBlocks):
    """Zeros that wander."""

    named = False

    def __init__(self, residuals: WhitenedResiduals) -> None:
        layout, kinds = InputLayout.of(residuals), np.array(residuals.baseline.setting.kinds)
        each = [np.flatnonzero(kinds == kind).tolist() for kind in sorted(set(kinds.tolist()))]
        super().__init__(
            [b for sensors in each if len(sensors) > 1 for b in of_kind(residuals, layout, sensors)], SPREADS
        )


def of_kind(residuals: WhitenedResiduals, layout: InputLayout, sensors: list[int]) -> Iterator[TermColumns]:
    """The wandering zeros of some sensors, by one law or the other, per standard error of a reading."""
    sigma = np.sqrt(residuals.baseline.variance)
    for law in KINDS:
        waves = law(layout.R)[:, -max(LEADING // len(sensors), FEWEST) :]
        W = np.concatenate([layout.on_sensor(i, waves * sigma[:, [i]]) for i in sensors], axis=1)
        prior = float(np.log(WANDERING / len(KINDS)))
        yield TermColumns((COURSE, tuple(sensors)), W, prior, course=UnknownCourse("the order measured"))
