"""The shapes that a single change can take through time: every hypothesis that a deviation is tested against.

Times t_0 < … < t_{n−1} of the sessions in years since the first, one column a hypothesis, per unit of its size:

    jump at the gap before session k       1[t ≥ t_k]                               k = 1 … n−1
    drift from the start                   t
    drift that began in the gap before k   max(t − t_{k−1} − u(t_k − t_{k−1}), 0)   k = 1 … n−1, u of `BEGINS`
    aging                                  ln(1 + t/τ)/ln(1 + 1/τ)                  τ of `AGES`
    aging that comes to an end             1 − e^{−t/τ}                             τ of `SETTLES`, in forecasts
    following the temperature              T(t) − T̄                                 in forecasts

A drift begins anywhere within its gap, each time alike, so its likelihood is the mean over u. With m nodes u is wrong
by 1/2m of a gap d at most, the course by r·d/2m: of a young drift that has to stay below a session's own uncertainty,
or a walk, which fits anything, takes the drift's place and its rate is not carried on. Aging is fast at first and slows
down as stresses relax and volatiles leave (logarithmic, as of quartz and electronics; Primak 1955); its unit is the
change of the first year, of one that comes to an end that in the end: how much relaxes is no matter of how soon.
Whether it goes on for ever, as a logarithm does, or comes to an end, as stresses that relax at one rate, hardly shows
within the readings and decides where they lead: detection does without the second, forecasts weigh both. A temperature
coefficient is found by `detection` where there are sessions enough; the few of a young history may show the season as
well as a drift, and forecasts weigh it too.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache

import numpy as np

from estimator.session import Array

AGES = (0.03, 0.3, 1.0)
"""τ, years: from days, as after an assembly, to a year."""
SLOW = 3.0
"""τ, years, of aging for forecasts beside `AGES`: of a unit that was assembled long before its first session, t + t_0
in place of t, much is gone, and ln(1 + t/(τ + t_0)) is left."""
SETTLES = (0.1, 0.3, 1.0, 3.0)
"""τ, years, of aging that comes to an end: what is slower cannot be distinguished from a drift."""
BEGINS = (0.125, 0.375, 0.625, 0.875)
"""u, parts of a gap: the middles of quarters. At half a tolerance a year and half a year between sessions a drift is
then wrong by 0.03 T at most, as much as a good session is uncertain of."""
BARELY = 1e-9
"""Years; sessions nearer than that are of one date, and nothing begins between them."""


class Kind(IntEnum):
    """Kind of change of a parameter."""

    NONE = 0
    JUMP = 1
    LATE = 2
    """A drift that began between two sessions."""
    START = 3
    """A drift since the first session."""
    AGING = 4
    WALK = 5
    """Random wander, without a steady rate."""
    SETTLING = 6
    """Aging that comes to an end."""
    WARMTH = 7
    """No change of its own: the parameter follows the temperature of the sessions."""


DRIFTS = (Kind.LATE, Kind.START, Kind.AGING)
"""Kinds of change that continue."""
STILL = (Kind.NONE, Kind.WARMTH)
"""Kinds in which no change has begun."""


@dataclass(frozen=True, eq=False)
class Shapes:
    """H hypotheses about n sessions."""

    columns: Array
    """(n, H) deviation per unit of size: dimensionless for jumps and aging, years for drifts, °C for temperature."""
    kind: Array
    """(H,) `Kind`."""
    gap: Array
    """(H,) number of the session before which the change came; 0 where it runs from the first."""
    share: Array
    """(H,) chance of this one among those of its kind, dimensionless: of a gap in proportion to its length."""
    constant: Array
    """(H,) τ of an aging, years; 1 elsewhere."""


def shapes(time: Array) -> Shapes:
    """The shapes for sessions at (n,) years since the first, increasing; at least two. All parameters of a unit share
    them.
    """
    return _shapes(time.tobytes())


@lru_cache(maxsize=8)
def _with_ends(moments: bytes, warmth: bytes) -> Shapes:
    family, time = _shapes(moments), np.frombuffer(moments)
    b = len(SETTLES)
    more = [course(time, SLOW), *(settled(time, age) for age in SETTLES), np.frombuffer(warmth)]
    kind = np.append(family.kind, [Kind.AGING, *[Kind.SETTLING] * b, Kind.WARMTH])
    share = np.append(family.share, [1.0, *[1 / b] * b, 1.0])
    share[kind == Kind.AGING] = 1 / (len(AGES) + 1)
    return Shapes(
        columns=np.concatenate([family.columns, np.stack(more, axis=1)], axis=1),
        kind=kind,
        gap=np.append(family.gap, np.zeros(len(more), dtype=int)),
        share=share,
        constant=np.append(family.constant, [SLOW, *SETTLES, 1.0]),
    )


def courses(time: Array, warmth: Array) -> Shapes:
    """All shapes, with aging that comes to an end and the temperature besides, for forecasts.

    Parameters
    ----------
    warmth : (n,) °C about their mean; zero where nothing is known of it, or it acts whatever else does.
    """
    return _with_ends(time.tobytes(), warmth.tobytes())


@lru_cache(maxsize=8)
def _shapes(moments: bytes) -> Shapes:
    time = np.frombuffer(moments)
    gap = np.diff(time)
    places = 1 + np.flatnonzero(gap > BARELY)
    among = gap[places - 1] / max(gap[places - 1].sum(), BARELY)
    begins = (time[places - 1][:, None] + gap[places - 1][:, None] * np.array(BEGINS)).ravel()
    jumps = (time[:, None] >= time[places]).astype(float)
    late = np.maximum(time[:, None] - begins, 0.0)
    aging = np.stack([course(time, age) for age in AGES], axis=1)
    m, a, b = len(places), len(AGES), len(BEGINS)
    return Shapes(
        columns=np.concatenate([jumps, late, time[:, None], aging], axis=1),
        kind=np.repeat([Kind.JUMP, Kind.LATE, Kind.START, Kind.AGING], [m, b * m, 1, a]),
        gap=np.concatenate([places, np.repeat(places, b), np.zeros(1 + a, dtype=int)]),
        share=np.concatenate([among, np.repeat(among, b) / b, [1.0], np.full(a, 1 / a)]),
        constant=np.concatenate([np.ones((1 + b) * m + 1), AGES]),
    )


def course(time: Array, age: Array | float) -> Array:
    """Aging at times since the first session, years, with a constant τ = ``age``, years; dimensionless."""
    return np.asarray(np.log1p(time / age) / np.log1p(1 / np.asarray(age)))


def settled(time: Array, age: Array | float) -> Array:
    """Aging that comes to an end, at times since the first session, years, with a constant ``age``, years;
    dimensionless.
    """
    return np.asarray(-np.expm1(-time / age))
