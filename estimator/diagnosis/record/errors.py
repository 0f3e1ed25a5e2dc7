"""Slips in the record that turn every axis or change places: undone first, before finer causes are sought.

Such a slip leaves nothing, or far too much, within the session; what tells it is that the fitted axes are far from
those of the unit's history (or the nominal ones), and that putting the record right brings them back.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.special import logsumexp

from estimator.causes import Correction
from estimator.causes.record import exchange_rows
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.errors import SessionError
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

TELLING = np.radians(2.0)
"""Angle from the expected axis, rad, beyond which the record is suspected."""

BETTER = 10.0
"""ln evidence by which the corrected record must win."""

GROSS = 20.0
"""χ² per degree of freedom beyond which exchanged rows are looked for."""


@dataclass(frozen=True, eq=False)
class Slip:
    """One slip found and undone."""

    cause: Correction
    places: tuple[int, ...]
    """Sensors, or rows counted from 0 for exchanged positions."""
    session: CalibrationSession
    """Put right."""
    evidence: float
    rivals: tuple[tuple[str, tuple[int, ...], float], ...]
    """Every slip tried: identifier, places, ln evidence."""


def misfit(baseline: Baseline, expected: Array) -> tuple[float, float]:
    """Sum of squared angles between fitted and expected axes (m, 3), and the largest, rad."""
    found = baseline.parameters.axis
    cosine = np.clip((found * expected).sum(axis=-1), -1.0, 1.0)
    chord = np.linalg.norm(found - expected, axis=-1)
    angle = np.where(cosine > 0.5, chord, np.arccos(cosine))
    return float((angle**2).sum()), float(angle.max())


def turned_record(
    session: CalibrationSession, baseline: Baseline, expected: Array, known: Sequence[Correction]
) -> Slip | None:
    """The slip that explains axes far from the expected ones, or None."""
    before, worst = misfit(baseline, expected)
    if worst < TELLING:
        return None
    m, tried = len(session.sensors), []
    for cause in known:
        if not cause.between or not usable(cause, session):
            continue
        ways = list(cause.corrected(session))
        for sensors, right in ways:
            after, largest = attempt(right, expected)
            if largest < worst / 3:
                floor = max(after, m * 1e-10)
                tried.append((m * float(np.log(before / floor)) - float(np.log(len(ways))), cause, sensors, right))
    if not tried:
        return None
    tried.sort(key=lambda t: -t[0])
    evidence, cause, sensors, right = tried[0]
    if evidence < BETTER:
        return None
    rivals = tuple((c.identifier, places, value) for value, c, places, _ in tried)
    return Slip(cause, sensors, right, evidence, rivals)


def attempt(session: CalibrationSession, expected: Array) -> tuple[float, float]:
    """Misfit of a corrected record; infinite where it cannot be calibrated at all."""
    try:
        return misfit(baseline_of(session), expected)
    except SessionError:
        return float("inf"), float("inf")


def usable(cause: Correction, session: CalibrationSession) -> bool:
    """Whether a correction makes sense for the session's programme and runs."""
    if session.programme != TWO_AXIS_STAND:
        return not cause.needs & {"stand", "both runs"}
    both = session.flipped is not None and bool(session.flipped.any()) and not bool(session.flipped.all())
    return both or "both runs" not in cause.needs


def exchanged_rows(baseline: Baseline, known: Sequence[Correction]) -> Slip | None:
    """Two rows whose readings are exchanged, or None.

    Screened linearly: exchanging rows j and k back changes the left-over by the difference of the two rows'
    simulated readings. The best few are tried by fitting the corrected record. Where noise is estimated from the
    left-over itself, what counts is how far the exchange brings the left-over down.
    """
    chi2, freedom = weighted_square(baseline), baseline.residual.size
    cause = next((c for c in known if c.of_rows), None)
    blind = bool(baseline.unstated.any())
    if cause is None or (not blind and chi2 < GROSS * freedom):
        return None
    session = baseline.session
    pairs = list(combinations(range(len(session.readings)), 2))
    gains = screen(baseline, pairs)
    if gains.max() < chi2 / 2:
        return None
    best = []
    for index in np.argsort(-gains)[:12]:
        j, k = pairs[int(index)]
        right = exchange_rows(session, j, k)
        after = float((baseline_of(right).residual ** 2 / baseline.variance).sum())
        best.append((0.5 * freedom * np.log(chi2 / after) if blind else 0.5 * (chi2 - after), after, (j, k), right))
    best.sort(key=lambda t: -t[0])
    weight, after, places, right = best[0]
    evidence = float(weight - np.log(len(pairs)))
    if evidence < BETTER or after > chi2 / 4:
        return None
    rivals = tuple((cause.identifier, p, float(w - np.log(len(pairs)))) for w, _, p, _ in best)
    return Slip(cause, places, right, evidence, rivals)


def weighted_square(baseline: Baseline) -> float:
    """χ² of the readings under their independent noise alone."""
    return float((baseline.residual**2 / baseline.variance).sum())


def screen(baseline: Baseline, pairs: Sequence[tuple[int, int]]) -> Array:
    """How much χ² each exchange would take away, the baseline refitted linearly; (pairs,)."""
    R, m = baseline.residual.shape
    left, weight = [], 1 / np.sqrt(baseline.variance)
    bases = []
    for i in range(m):
        design = baseline.design[:, i, :] * weight[:, i, None]
        u, s, _ = np.linalg.svd(design, full_matrices=False)
        bases.append(u[:, s > 1e-9 * s[0]])
        left.append(baseline.residual[:, i] * weight[:, i])
    measured = baseline.residual + baseline.setting.a
    gains = np.zeros(len(pairs))
    j, k = np.array(pairs).T
    for i in range(m):
        jump = (measured[k, i] - measured[j, i])[:, None]
        change = np.zeros((len(pairs), R))
        rows = np.arange(len(pairs))
        change[rows, j], change[rows, k] = jump[:, 0] * weight[j, i], -jump[:, 0] * weight[k, i]
        change -= (change @ bases[i]) @ bases[i].T
        gains -= 2 * change @ left[i] + (change**2).sum(axis=1)
    return gains


def posterior(slip: Slip) -> list[tuple[str, tuple[int, ...], float]]:
    """Share of each slip tried, given that one of them happened."""
    values = np.array([value for _, _, value in slip.rivals])
    share = np.exp(values - logsumexp(values))
    return [(name, places, float(p)) for (name, places, _), p in zip(slip.rivals, share, strict=True)]


def expected_axes(history: Sequence[Baseline], session: CalibrationSession) -> Array:
    """(m, 3) the axes to expect: those of the latest comparable session, else the nominal ones."""
    names = tuple(s.name for s in session.sensors)
    for earlier in reversed(history):
        if tuple(s.name for s in earlier.session.sensors) == names:
            return earlier.parameters.axis
    return np.stack([s.nominal_axis for s in session.sensors])
