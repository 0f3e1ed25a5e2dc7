"""A wrong elevation recognised by the nominal axes, where a unit has no history.

The axes of a block stray from nominal, nobody knows how far; a wrong α moves them all in one pattern. Their deviations
are regressed on that pattern and judged by F: the strays themselves are the noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import tangents
from estimator.causes.contract import Cause, Entry
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.parameters import LIMIT
from estimator.session import TWO_AXIS_STAND, CalibrationSession
from estimator.significance import p_value

LEVEL = 1e-3
"""p-value of one cause against the nominal axes: a third of the family-wise level, for it is one test of its own."""

LEAST = np.radians(0.005)
"""rad; how near to nominal no maker claims to mount his axes."""

ROUNDS = 4
"""Corrections: the pattern is taken anew at the corrected elevation."""


@dataclass(frozen=True, eq=False)
class WrongEntry:
    """An entry of the record found wrong against the nominal axes."""

    cause: Entry
    amplitude: float
    """Amplitude in the cause's unit."""
    sigma: float
    p_value: float
    strength: float
    """Standard errors."""

    def corrected(self, session: CalibrationSession) -> CalibrationSession:
        """The session with the entry corrected."""
        return self.cause.corrected_by(session, self.amplitude)


def wrong_entry(session: CalibrationSession, catalogue: Sequence[Cause]) -> WrongEntry | None:
    """The entry whose correction brings the axes back to nominal; None where the strays explain them as they are."""
    cause = next((c for c in catalogue if isinstance(c, Entry)), None)
    if cause is None or session.programme != TWO_AXIS_STAND:
        return None
    amount, sigma, f, freedom = regression(baseline_of(session), cause)
    if freedom < 3 or (chance := float(p_value(f, 1, freedom))) > LEVEL:
        return None
    total, right = 0.0, session
    for _ in range(ROUNDS):
        total += amount
        right = cause.corrected_by(session, total)
        amount, sigma, _, _ = regression(baseline_of(right), cause)
    return WrongEntry(cause, total, sigma, chance, float(np.sqrt(f)))


def regression(baseline: Baseline, cause: Entry) -> tuple[float, float, float, int]:
    """Amplitude, its sigma, F and the degrees of freedom of the axes' deviations from nominal."""
    residuals = WhitenedResiduals.of(baseline)
    (shape,) = cause.shapes(baseline.setting)
    m = len(baseline.setting.kinds)
    axes = (5 * np.arange(m)[:, None] + np.array([3, 4])).ravel()
    pattern = (residuals.response @ residuals.whitened(shape.columns))[axes, 0]
    nominal = np.stack([s.nominal_axis for s in baseline.session.sensors])
    frame = tangents(baseline.parameters.axis)
    stray = (np.swapaxes(frame, -1, -2) @ (baseline.parameters.axis - nominal)[..., None]).ravel()
    known = np.sqrt(np.diagonal(baseline.covariance)[axes]) < LIMIT
    pattern, stray = pattern[known], stray[known]
    size = float(pattern @ pattern)
    if size == 0 or len(stray) < 4:
        return 0.0, np.inf, 0.0, 0
    amount = float(pattern @ stray) / size
    freedom = len(stray) - 1
    rest = max(float(((stray - pattern * amount) ** 2).sum()) / freedom, LEAST**2)
    return amount, float(np.sqrt(rest / size)), amount**2 * size / rest, freedom
