"""Disturbances of the block: steps, bursts, shaking, clipping.

Steps are outliers among the differences of neighbouring windows of means, bursts among the variances within means. Both
are measured in the spread that the record itself shows, by medians, so that slow noise and a warming unit make no
steps; thresholds hold over all windows and sensors together.
"""

import numpy as np
from scipy.special import stdtrit

from estimator.least_squares import least_squares
from estimator.readiness.results import Disturbance, DisturbanceKind
from estimator.readiness.series import Series
from estimator.session import Array

FALSE_ALARMS = 0.01
"""Chance of a false alarm in a still record, over all that is looked at."""
WINDOW = 5
"""Means beside a step that are compared: enough that one mean alone is none."""
AROUND = 3
"""Windows on each side whose differences say what is usual there."""
TWICE = 4.0
"""Times the usual variance from which a burst matters: twice the scatter."""
SURE = 5.0
"""Standard errors that a step must have beside a smooth course, and it must exceed what is allowed there as well: the
curve of a unit that warms up quickly makes no step."""
SMOOTH = 3
"""Degree of that course."""
TO_NORMAL = 1.4826
"""Factor from the median of absolute deviations to a standard deviation."""
CLIPPED = 0.005
"""Share of samples at one end of a channel's range, from which it is clipped, if they come in rows."""
IN_A_ROW = 4
"""Samples that stand at the end together; fewer are noise that reaches the same code."""


def first_and_last(series: Series, names: tuple[str, ...], allowed: Array) -> list[tuple[int, Disturbance]]:
    """Steps and bursts with the mean from which on the record is calm again; ``allowed`` (m,) m/s² or rad/s."""
    return sorted(_steps(series, names, allowed) + _bursts(series, names), key=lambda pair: pair[0])


def _steps(series: Series, names: tuple[str, ...], allowed: Array) -> list[tuple[int, Disturbance]]:
    n, m = series.value.shape
    middles = np.arange(WINDOW, n - WINDOW + 1)
    same = np.array([len(set(series.place[k - WINDOW : k + WINDOW])) == 1 for k in middles], dtype=bool)
    middles = middles[same]
    if len(middles) < 2 * WINDOW:
        return []
    sums = np.concatenate([np.zeros((1, m)), np.cumsum(series.value, axis=0)])
    jump = (sums[middles + WINDOW] - 2 * sums[middles] + sums[middles - WINDOW]) / WINDOW
    away = jump - _usual(jump)
    spread = TO_NORMAL * np.median(np.abs(away), axis=0)
    least = np.sqrt(2 / WINDOW) * TO_NORMAL * np.median(np.abs(np.diff(series.value, axis=0)), axis=0) / np.sqrt(2)
    bound = -stdtrit(max(n / WINDOW - 1, 2), FALSE_ALARMS / (4 * away.size)) * np.maximum(spread, least)
    far = (np.abs(away) > bound) & (np.abs(away) > allowed)
    steps = [_step(series, names, middles, away, far, run) for run in _runs(far.any(axis=1))]
    return [step for step in steps if _is_sharp(series, names, step, allowed)]


def _is_sharp(series: Series, names: tuple[str, ...], candidate: tuple[int, Disturbance], allowed: Array) -> bool:
    """Whether some sensor has a step there that no smooth course through the means around it explains."""
    at = candidate[0] - 1
    rows = slice(max(at - AROUND * WINDOW, 0), at + AROUND * WINDOW)
    t = series.time[rows] - series.time[at]
    after = np.arange(len(series.time))[rows] >= at
    X = np.column_stack([after, np.vander(t / np.abs(t).max(), SMOOTH + 1)])
    members = [i for i, name in enumerate(names) if name in candidate[1].sensors]
    fit = least_squares(X, series.value[rows][:, members])
    error, step = np.sqrt(fit.chi2 / fit.freedom * fit.covariance[0, 0]), np.abs(fit.value[0])
    return bool(((step > SURE * error) & (step > allowed[members])).any())


def _usual(jump: Array) -> Array:
    """Median of the differences around each, itself and what overlaps with it left out where there are others."""
    usual = np.empty_like(jump)
    for k in range(len(jump)):
        near = np.r_[max(k - AROUND * WINDOW, 0) : max(k - WINDOW, 0), k + WINDOW : min(k + AROUND * WINDOW, len(jump))]
        usual[k] = np.median(jump[near] if len(near) else jump, axis=0)
    return usual


def _step(
    series: Series, names: tuple[str, ...], middles: Array, away: Array, far: Array, run: tuple[int, int]
) -> tuple[int, Disturbance]:
    rows = slice(*run)
    sizes = np.where(far[rows], np.abs(away[rows]), 0.0)
    peak = int(sizes.max(axis=1).argmax())
    k = int(middles[rows][peak])
    moved = tuple(name for name, size in zip(names, sizes.max(axis=0), strict=True) if size > 0)
    start, stop = series.edges[k - 1, 0], series.edges[k, 1]
    return min(k + 1, len(series.time)), Disturbance(
        DisturbanceKind.STEP, moved, float(start), float(stop), float(sizes.max())
    )


def _bursts(series: Series, names: tuple[str, ...]) -> list[tuple[int, Disturbance]]:
    if series.count.min() < 4 or not (series.inner > 0).all():  # too few samples a mean, or hardly any noise
        return []
    level = np.log(series.inner)
    away = level - np.median(level, axis=0)
    least = np.sqrt(2 / (np.median(series.count) - 1))
    spread = np.maximum(TO_NORMAL * np.median(np.abs(away), axis=0), least)
    bound = -stdtrit(max(len(level) / 4, 4), FALSE_ALARMS / (2 * away.size)) * spread
    far = away > np.maximum(bound, np.log(TWICE))
    bursts = []
    for start, stop in _runs(far.any(axis=1)):
        shaken = tuple(name for name, is_shaken in zip(names, far[start:stop].any(axis=0), strict=True) if is_shaken)
        size = float(np.sqrt(np.where(far[start:stop], series.inner[start:stop], 0.0).max()))
        first, last = float(series.edges[start, 0]), float(series.edges[stop - 1, 1])
        bursts.append((stop, Disturbance(DisturbanceKind.BURST, shaken, first, last, size)))
    return bursts


def _runs(flag: Array) -> list[tuple[int, int]]:
    """Stretches [start, stop) of what holds."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flag, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in zip(edges[::2], edges[1::2], strict=True)]


def shaking(series: Series, names: tuple[str, ...], quadratic: Array, allowed: Array) -> list[Disturbance]:
    """Sensors whose vibration, rectified by a quadratic term (m,) of the size allowed, shifts them too far.

    A sensor with the term c shows c·E(f²), so vibration of the variance v shifts its mean by c·v.
    """
    level = np.median(series.inner, axis=0)
    far = np.nan_to_num(level) * quadratic > allowed
    if not far.any():
        return []
    size = float(np.sqrt(level[far].max()))
    shaken = tuple(name for name, is_shaken in zip(names, far, strict=True) if is_shaken)
    return [Disturbance(DisturbanceKind.SHAKING, shaken, float(series.edges[0, 0]), float(series.edges[-1, 1]), size)]


def clipped(readings: Array, names: tuple[str, ...], until: float) -> list[Disturbance]:
    """Channels (R, m) of samples that stand at the end of their range in rows."""
    disturbances = []
    for name, channel in zip(names, readings.T, strict=True):
        ends = [channel == end for end in (channel.min(), channel.max())]
        share = max(_in_rows(end) for end in ends)
        if share > CLIPPED and len(np.unique(channel)) > IN_A_ROW:
            disturbances.append(Disturbance(DisturbanceKind.CLIPPED, (name,), 0.0, until, share))
    return disturbances


def _in_rows(flag: Array) -> float:
    """Share of samples for which it holds together with `IN_A_ROW` − 1 neighbours or more."""
    return sum(stop - start for start, stop in _runs(flag) if stop - start >= IN_A_ROW) / len(flag)
