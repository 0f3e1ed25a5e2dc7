"""How wide the noise of residuals is drawn: as it was stated, and as it was found where the readings scatter more."""

from dataclasses import dataclass
from math import isfinite, sqrt

import altair as alt
import numpy as np

from estimator.results import Calibration, Residuals
from estimator.session import Array

WIDER = 1.01
"""Times by which the noise found must be larger to be drawn of its own: less is not told apart by eye."""
DASHES = [4, 3]
"""Pixels drawn and left out of the edge of the noise that was found."""


@dataclass(frozen=True, eq=False)
class Noise:
    """The noise of R rows of m sensors."""

    stated: Array
    """(R, m) one sigma at the input, m/s² or rad/s: as the file states it, estimated where it states none."""
    growth: Array
    """(m,) how many times as large the calibration reckons with, no less than 1."""

    @property
    def found(self) -> Array:
        """(R, m) one sigma that the calibration reckons with, m/s² or rad/s."""
        return self.stated * self.growth

    @property
    def times(self) -> float | None:
        """How many times the noise found is the stated one, at the sensor where most; None where it is not drawn."""
        most = float(self.growth.max(initial=1.0))
        return most if most > WIDER else None

    def edge(self, row: int, column: int, factor: float) -> float | None:
        """2σ found of a reading, in a measure; None where it is not drawn of its own."""
        return float(f"{2 * self.found[row, column] * factor:.4g}") if self.growth[column] > WIDER else None


def noise_of(residuals: Residuals, calibration: Calibration) -> Noise:
    """Stated as of some residuals, found as of a calibration of the same session.

    The median over a sensor's rows, because readings that take no part are given a sigma beyond all bounds.
    """
    stated, own = _stated(residuals), _stated(calibration.residuals)
    factor = calibration.fit.covariance_factor
    if calibration.residuals.enlarged_by is None or not isfinite(factor):
        return Noise(stated, np.ones(stated.shape[1]))
    known = np.isfinite(stated) & np.isfinite(own) & (stated > 0)
    ratio = np.divide(own, stated, out=np.ones_like(stated), where=known)
    return Noise(stated, np.maximum(1.0, np.median(ratio, axis=0) * sqrt(max(factor, 1.0))))


def _stated(residuals: Residuals) -> Array:
    return np.asarray(residuals.sigma / (residuals.enlarged_by or 1.0))


def edges(base: alt.Chart, scale: alt.Scale, colour: str) -> list[alt.Chart]:
    """Dashed lines at both edges of the noise found; ``base`` has x and, in its data, ``found``."""
    drawn = base.transform_filter("isValid(datum.found)").transform_calculate(opposite="-datum.found")
    line = drawn.mark_line(color=colour, strokeDash=DASHES, strokeWidth=1)
    return [line.encode(y=alt.Y(f"{name}:Q", scale=scale), detail="run:N") for name in ("found", "opposite")]
