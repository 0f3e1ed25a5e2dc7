"""A unit's outlook: every parameter's trend and forecast, and the risk that any of them is out of tolerance.

An axis deviates in two directions. Its series are the components along and across its latest measured deviation: the
first carries the angle's drift and its steps, the second only adds to the risk. Because that direction was chosen by
looking, a p-value of the first counts as that of the largest of all directions: exp(−t²/2) in place of 2Φ(−t).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from estimator.health.forecast import AHEAD, EARLY, MEDIAN, passage, reach, together
from estimator.health.trend import STEP_LEVEL, Series, Trends, trends
from estimator.session import Array

RECENT = 60
"""Sessions, the newest, that a trend is made of; older ones hardly tell of a level that walks."""
KNOWN = 0.5
"""A level is known well enough for a forecast while its sigma is below this part of the tolerance: U = 2·u below T, as
the decision rule asks."""


@dataclass(frozen=True, eq=False)
class Track:
    """One parameter of one sensor since the last break, the reference session included."""

    time: Array
    """(n,) years, increasing."""
    change: Array
    """(n, k) deviation from the recorded reference, SI or relative; k = 1, for an axis 2 along its reference's tangents
    (rad)."""
    sigma: Array
    """(n, k) standard uncertainty that each session brings, unit of the change; of the reference session its own."""
    tolerance: float
    """Unit of the change."""


@dataclass(frozen=True, eq=False)
class Outlook:
    """What one track says; SI a year, years."""

    level: float
    level_sigma: float
    rate: float
    rate_sigma: float
    p_value: float
    steps: tuple[int, ...]
    """Places in the track's sessions at which the value was first seen after a sudden change."""
    chance: Array
    """(h,) probability of having reached the tolerance by `AHEAD` after the track's last session."""
    reach_50: float
    """Years after the last session; infinite beyond the horizon."""
    reach_90: float
    """Before it the tolerance is reached with 10 % probability."""
    is_known: bool
    """Whether the level is known well enough for the forecast to mean anything."""
    series: int
    """Place of its main series in the trends."""


@dataclass(frozen=True, eq=False)
class Prognosis:
    """All tracks of a unit."""

    outlooks: tuple[Outlook, ...]
    trends: Trends
    """Of every track's main series, then of the axes' second ones; in tolerances."""
    risk: Array
    """(h,) probability that any known parameter has reached its tolerance by `AHEAD` after the latest session."""


def prognosis(tracks: Sequence[Track]) -> Prognosis:
    """The outlook of every track, and of the unit as a whole; at least one track, each with two sessions or more."""
    main, across = [], list[tuple[int, Series]]()
    for i, track in enumerate(tracks):
        own = _series(track)
        main.append(own[0])
        across += [(i, other) for other in own[1:]]
    level = -np.expm1(np.log1p(-STEP_LEVEL) / len(tracks))
    found = trends([*main, *(series for _, series in across)], step_level=level)
    chance = passage(found)
    for place, (i, _) in enumerate(across):
        chance[i] = np.minimum(chance[i] + chance[len(tracks) + place], 1.0)
    outlooks = tuple(_outlook(track, found, i, chance[i]) for i, track in enumerate(tracks))
    return Prognosis(outlooks, found, _risk(tracks, outlooks))


def _series(track: Track) -> list[Series]:
    """Of a number its deviations, of an axis those along and across the direction it points in."""
    time, change, sigma = track.time[-RECENT:], track.change[-RECENT:], track.sigma[-RECENT:]
    if change.shape[1] == 1:
        return [Series(time, change[:, 0], sigma[:, 0], track.tolerance)]
    along = direction(track)
    across = np.array([-along[1], along[0]])
    return [Series(time, change @ u, np.sqrt(sigma**2 @ u**2), track.tolerance) for u in (along, across)]


def direction(track: Track) -> Array:
    """(2,) unit vector, dimensionless: where the axis points from its reference, the mean of the last three sessions by
    their precision."""
    weight = track.sigma[-3:].max(axis=1, keepdims=True) ** -2.0
    mean = (weight * track.change[-3:]).sum(axis=0)
    length = float(np.hypot(*mean))
    return mean / length if length > 0 else np.array([1.0, 0.0])


def _outlook(track: Track, found: Trends, i: int, chance: Array) -> Outlook:
    """Of a track whose main series is the i-th; chance (h,) is the probability of having reached the tolerance."""
    unit = track.tolerance
    last = int(found.there[i].sum()) - 1
    skipped = max(len(track.time) - RECENT, 0)
    p = float(found.p_value[i])
    if track.change.shape[1] == 2:
        p = float(np.exp(-(ndtri(max(p, 1e-300) / 2) ** 2) / 2))
    return Outlook(
        level=float(found.level[i, last]) * unit,
        level_sigma=float(found.level_sigma[i, last]) * unit,
        rate=float(found.rate[i]) * unit,
        rate_sigma=float(found.rate_sigma[i]) * unit,
        p_value=p,
        steps=tuple(int(k) + skipped for k in np.flatnonzero(found.steps[i])),
        chance=chance,
        reach_50=float(reach(chance[None], MEDIAN)[0]),
        reach_90=float(reach(chance[None], EARLY)[0]),
        is_known=bool(found.level_sigma[i, last] < KNOWN),
        series=i,
    )


def _risk(tracks: Sequence[Track], outlooks: Sequence[Outlook]) -> Array:
    """(h,) probability that any known parameter is out by `AHEAD` after the latest session of all tracks."""
    latest = max(float(track.time[-1]) for track in tracks)
    rows = [
        np.interp(AHEAD + latest - float(track.time[-1]), AHEAD, outlook.chance)
        for track, outlook in zip(tracks, outlooks, strict=True)
        if outlook.is_known
    ]
    return together(np.stack(rows)) if rows else np.zeros_like(AHEAD)
