"""Gyros at rest in unknown orientations: the bias and nothing else.

The Earth's rate Ω acts along an unknown direction in every orientation, so its projection on an input axis is a bounded
unknown of mean square Ω²/3. From one orientation to the next it is drawn anew; the mean over the rows keeps its share.
A gyro whose rows scatter more than noise and Earth rate explain has the uncertainty of the scatter. Scale, axis and
nonlinearity need rates that a resting block does not see.
"""

from dataclasses import dataclass

import numpy as np

from estimator.applied_vector import EARTH_RATE
from estimator.calibration.free.excess import UNLIKELY
from estimator.session import Array
from estimator.significance import p_value

WEIGHTLESS = 100.0
"""One sigma, rad/s, from which a reading takes no part: no gyro at rest is as bad."""


@dataclass(frozen=True, eq=False)
class GyroBiases:
    """Biases of k gyros over R rows, at the input, rad/s."""

    bias: Array
    """(k,) rad/s."""
    sigma: Array
    """(k,) rad/s, Earth rate included."""
    residual: Array
    """(R, k) rad/s."""
    noise: Array
    """(R, k) one sigma of the independent noise of each reading, rad/s."""
    stated: bool
    """Whether the noise was stated."""
    freedom: Array
    """(k,) degrees of freedom of sigma: infinite where it is the stated one, NaN where a single row gives none."""

    @property
    def chi2(self) -> float:
        """Squared residuals against noise and Earth rate together."""
        return float(np.sum(self.residual**2 / (self.noise**2 + EARTH_RATE**2 / 3)))

    @property
    def dof(self) -> int:
        """Readings, less one bias a gyro."""
        return int((self.noise < WEIGHTLESS).sum()) - len(self.bias)


def rest_biases(readings: Array, standard_errors: Array, repeatability: Array) -> GyroBiases:
    """Weighted means over the rows.

    Parameters
    ----------
    readings : (R, k) rad/s by the nominal scale, nominal offset taken off.
    standard_errors : (R, k) rad/s; NaN where not stated: then the scatter of the rows is taken; beyond
        `WEIGHTLESS` where a reading takes no part.
    repeatability : (k,) rad/s.
    """
    out, known = standard_errors > WEIGHTLESS, ~np.isnan(standard_errors)
    R = np.maximum((~out).sum(axis=0), 1)
    middle = np.where(out, 0.0, readings).sum(axis=0) / R
    squared = np.where(out, 0.0, (readings - middle) ** 2).sum(axis=0)
    scatter = np.where(R > 1, np.sqrt(squared / np.maximum(R - 1, 1)), np.abs(readings[0]))
    noise = np.where(known, np.hypot(np.where(known, standard_errors, 0.0), repeatability), scatter)
    variance = noise**2 + EARTH_RATE**2 / 3
    bias = (readings / variance).sum(axis=0) / (1 / variance).sum(axis=0)
    sigma = 1 / np.sqrt((1 / variance).sum(axis=0))
    squares = ((readings - bias) ** 2 / variance).sum(axis=0)
    spare = np.maximum(R - 1, 1)
    restless = p_value(squares, spare) < UNLIKELY
    sigma = sigma * np.where(restless, np.sqrt(squares / spare), 1.0)
    estimated = restless | ~known.all(axis=0)
    freedom = np.where(estimated, np.where(R > 1, R - 1.0, np.nan), np.inf)
    return GyroBiases(bias, sigma, readings - bias, noise, bool(known.all()), freedom)
