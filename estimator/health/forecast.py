"""The time at which a parameter reaches its tolerance, and the risk of waiting. Years from the last session.

Every draw of `posterior` goes on: l(h) = l + r·h + a·(aging) + q·B(h), and is out of tolerance once |l(h)| ≥ T; of an
axis |l| is the length, the tolerance a disc. Between two dates at which a draw is followed, a walk from x to y that is
within at both has passed the tolerance with the chance exp(−2(1 − |x|)(1 − |y|)/(q²Δt)) of a Brownian bridge (Siegmund
1986; of a disc, of its tangent). What has not happened yet may: jumps come with the rate λ_s of the type and pass the
tolerance from |l| with the chance g_s(|l|), drifts begin with a rate of theirs, so that within tolerance at h are

    exp(−∫ Σ_s λ_s g_s(|l(u)|) du − Σ_r λ_r ∫ P(|l(h) + r·v| ≥ 1) dv)

of a draw. The rates λ of one in which nothing has begun yet fall with the years (`pooled`), here on the average up to
h; in one that has changed the next change comes at the rates of units in general at most. Where temperature moves the
parameter, the tolerance holds for the whole span of temperatures that was seen.
Given the type, parameters move on their own: the unit's chance is that of them together.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.special import chndtr, ndtr

from estimator.health.fits import PART_KINDS, PART_SIZES
from estimator.health.pooled import Prior
from estimator.health.posterior import Draws
from estimator.health.shapes import DRIFTS, STILL, Kind
from estimator.session import Array

AHEAD = np.concatenate([[0.0], np.geomspace(0.02, 12.0, 30)])
"""(31,) years at which the chance is worked out; between them it is interpolated. Twelve years outlast any interval."""
MEDIAN, EARLY = 0.5, 0.1
"""Chances whose dates are stated: as likely as not, and the 90 % bound."""
WHICHEVER = 0.2
"""Chance of reaching the tolerance before the 90 % bound of a history that turns out to drift: twice that of all."""
ALIKE = (*((kind,) for kind in DRIFTS), (Kind.LATE, Kind.START))
"""Drifts that a date holds for: each kind of its own, and steady ones whenever they began."""
RISK_LEVEL = 0.05
"""Chance of a unit being out of tolerance that its next calibration must come before."""
DISTANCES = np.linspace(0.0, 1.0, 41)
"""(41,) T, at which chances of passing are tabulated; linear between them is right to 1e-3."""
PATHS, SEED = 1601, 1986
"""Random walks that are followed, more than there are draws, so that no parameter takes one twice; and their seed."""
FRACTIONS = (np.arange(8) + 0.5) / 8
"""(8,) fractions of the time ahead, at which a drift may have begun: the middle of eighths."""


def followed(draws: Draws, ahead: Array, rng: np.random.Generator) -> Array:
    """(N, k, h) levels of every draw at increasing years ahead (h,), new jumps and drifts apart; T."""
    level = draws.level[..., None] + draws.rate[..., None] * ahead
    walks = np.flatnonzero(draws.walk)
    path = (walks + rng.integers(PATHS)) % PATHS
    level[walks] += _paths(level.shape[1], ahead.tobytes())[path] * draws.walk[walks, None, None]
    ages = draws.aging.any(axis=1)
    level[ages] += draws.aging[ages, :, None] * draws.aged(ahead)[ages, None, :]
    return np.asarray(level)


@lru_cache(maxsize=4)
def _paths(k: int, ahead: bytes) -> Array:
    """(`PATHS`, k, h) random walks of 1 a root year at years ``ahead`` (h,), as its bytes: every parameter of a unit
    takes the same in an order of its own."""
    steps = np.diff(np.frombuffer(ahead), prepend=0.0)
    taken = np.random.default_rng(SEED).standard_normal((PATHS, k, len(steps)))
    return np.cumsum(taken * np.sqrt(steps), axis=2)


def passed(weight: Array, stays: Array) -> Array:
    """(h,) probability, never falling, of draws with weights (N,) that stay within with chances (N, h)."""
    return np.asarray(np.maximum.accumulate(np.clip(1 - weight @ stays, 0.0, 1.0)))


def earliest(draws: Draws, stays: Array, *, drifts: bool) -> float:
    """Years before which the tolerance is reached with the chance `EARLY`, and with `WHICHEVER` at most of every kind
    of drift that the history leaves open; with `EARLY` of it too once it is known that it ``drifts``.

    Over all that a history may be, one that goes on hides behind those that do not: at a share s of it the chance
    `EARLY` of all may be `EARLY`/s of its own. So does a young and steep drift behind a slow one from the start. A kind
    with a share below `EARLY` cannot break the claim.
    """
    level = EARLY if drifts else WHICHEVER
    times = [float(reach(passed(draws.weight, stays)[None], EARLY)[0])]
    for kinds in ALIKE:
        weight = draws.weight * np.isin(draws.kind, kinds)
        if weight.sum() >= EARLY:
            times.append(float(reach(passed(weight / weight.sum(), stays)[None], level)[0]))
    return min(times)


def staying(draws: Draws, prior: Prior, swing: Array | float, rng: np.random.Generator) -> Array:
    """(N, h) chance of every draw to be within the tolerance at all times up to `AHEAD`.

    Parameters
    ----------
    swing : T, that temperature takes off the tolerance on either side; one of all draws, or (N, 1) of each.
    """
    level = followed(draws, AHEAD, rng)
    length = (np.abs(level[:, 0]) if level.shape[1] == 1 else np.hypot(level[:, 0], level[:, 1])) + swing
    within = (length < 1).astype(float)
    walks = np.flatnonzero(draws.walk)
    inside = np.maximum(1 - length[walks], 0.0)
    spread = draws.walk[walks, None] ** 2 * np.diff(AHEAD)
    within[walks, 1:] = -np.expm1(-2 * inside[:, :-1] * inside[:, 1:] / spread)
    within = np.cumprod(within, axis=1)
    k, quiet, near = draws.level.shape[1], np.isin(draws.kind, STILL), np.minimum(length, 1.0)
    within[quiet] *= np.exp(-_hazard(near[quiet], prior.rate, k) * prior.remaining_rate(draws.age, AHEAD))
    within[~quiet] *= np.exp(-_hazard(near[~quiet], prior.again, k))
    return np.asarray(within)


def _hazard(length: Array, rate: Array, k: int) -> Array:
    """(N, h) expected number of new events that take a draw at (N, h) lengths, T, beyond its tolerance by `AHEAD`."""
    jumps, drifts = PART_KINDS == Kind.JUMP, PART_KINDS == Kind.LATE
    at_once = np.broadcast_to(rate[jumps] @ _beyond_jump(k), (len(AHEAD), len(DISTANCES)))
    now, drifted = _looked_up((at_once, np.tensordot(rate[drifts], _beyond_drift(k), axes=1)), length)
    drifted[:, 1:] += np.cumsum((now[:, :-1] + now[:, 1:]) / 2 * np.diff(AHEAD), axis=1)
    return drifted


def _looked_up(tables: tuple[Array, ...], length: Array) -> list[Array]:
    """(N, h) values of each table (h, 41) over `DISTANCES`, linear between them, at (N, h) lengths from 0 to 1 T."""
    steps = len(DISTANCES) - 1
    beyond = length * steps
    place = np.minimum(beyond.astype(int), steps - 1)
    beyond -= place
    place += np.arange(length.shape[1]) * steps
    return [np.take(table[:, :-1], place) + beyond * np.take(np.diff(table), place) for table in tables]


@lru_cache(maxsize=2)
def _beyond_jump(k: int) -> Array:
    """(s, 41) chance that a jump from each distance passes the tolerance, of each size."""
    sizes = PART_SIZES[PART_KINDS == Kind.JUMP]
    return np.array([_beyond(DISTANCES, np.array(size), k) for size in sizes])


@lru_cache(maxsize=2)
def _beyond_drift(k: int) -> Array:
    """(s, h, 41) integral over its beginning, years, of the chance that a new drift passes the tolerance by `AHEAD`."""
    rates = PART_SIZES[PART_KINDS == Kind.LATE]
    since = AHEAD[:, None] * FRACTIONS
    reached = [_beyond(DISTANCES, rate * since[..., None], k).mean(axis=1) * AHEAD[:, None] for rate in rates]
    return np.array(reached)


def _beyond(distance: Array, sigma: Array, k: int) -> Array:
    """P(|x| ≥ 1) of x ~ N(distance, sigma² I) in k dimensions, T; broadcast."""
    sigma = np.maximum(sigma, 1e-6)
    if k == 1:
        return np.asarray(ndtr((distance - 1) / sigma) + ndtr(-(distance + 1) / sigma))
    near = np.maximum(sigma, 1e-2)  # narrower ones pass only from the edge, and the series of χ² grows long
    return np.asarray(1 - chndtr(near**-2.0, k, (distance / near) ** 2))


def reach(chance: Array, level: float, ahead: Array = AHEAD) -> Array:
    """The time at which the chance of having reached the tolerance passes a level.

    Parameters
    ----------
    chance : (B, h) probability, never falling.
    level : the probability asked for.
    ahead : (h,) years at which the chances hold.

    Returns
    -------
    (B,) years; infinite beyond the last of ``ahead``.
    """
    return np.array([np.interp(level, row, ahead, right=np.inf) for row in chance])


def together(chance: Array) -> Array:
    """(h,) probability that any of B parameters, each with a probability (B, h), has reached its tolerance."""
    return np.asarray(-np.expm1(np.log1p(-np.minimum(chance, 1 - 1e-15)).sum(axis=0)))


@dataclass(frozen=True, eq=False)
class Future:
    """Levels at some dates, new events among them, as weighted draws."""

    weight: Array
    """(N,) summing to one."""
    level: Array
    """(N, k, h) T."""

    def quantiles(self, levels: tuple[float, ...], direction: Array) -> Array:
        """(len(levels), h) of the level along a ``direction`` (k,), T."""
        columns = []
        for column in np.einsum("nkh,k->hn", self.level, direction):
            order = np.argsort(column)
            below = np.cumsum(self.weight[order]) - self.weight[order] / 2
            columns.append(np.interp(levels, below, column[order]))
        return np.array(columns).T

    def below(self, value: Array, sigma: Array) -> Array:
        """(h,) probability of a reading of the first component below ``value`` (h,) with its own ``sigma`` (h,), T."""
        return np.asarray(np.einsum("n,nh->h", self.weight, ndtr((value - self.level[:, 0, :]) / sigma)))


def future(draws: Draws, prior: Prior, ahead: Array, rng: np.random.Generator) -> Future:
    """Levels at increasing years ahead (h,), with jumps and drifts that the type lets expect."""
    level, quiet, again = followed(draws, ahead, rng), np.isin(draws.kind, STILL), prior.again
    last = float(ahead[-1])
    effective = last * float(prior.remaining_rate(draws.age, ahead[-1:])[0])
    for part in map(int, np.flatnonzero(prior.rate)):
        rows, expected = _next_jumps(quiet, prior.rate[part], effective, rng)
        _move(level, rows, part, (prior.comes(draws.age, expected), ahead), rng)
        rows, come = _next_jumps(~quiet, again[part], last, rng)
        _move(level, rows, part, (come, ahead), rng)
    return Future(draws.weight, level)


def _next_jumps(per_draw: Array, rate: float, years: float, rng: np.random.Generator) -> tuple[Array, Array]:
    """(m,) places among ``per_draw`` (N,) bool in which an event comes within years, and (m,) years until it does."""
    chance = -np.expm1(-rate * years)
    rows = np.flatnonzero(per_draw)
    rows = rows[rng.random(len(rows)) < chance]
    return rows, -np.log1p(-chance * rng.random(len(rows))) / rate


def _move(level: Array, rows: Array, part: int, when: tuple[Array, Array], rng: np.random.Generator) -> None:
    """Adds an event of a part to levels (N, k, h) of ``rows`` (m,), at (m,) of years ahead (h,)."""
    come, ahead = when
    size = PART_SIZES[part] * rng.standard_normal((len(rows), level.shape[1], 1))
    since = np.maximum(ahead - come[:, None], 0.0)[:, None, :]
    level[rows] += size * (since if PART_KINDS[part] == Kind.LATE else since > 0)
