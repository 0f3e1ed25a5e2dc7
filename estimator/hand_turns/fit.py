"""Gyros of greatest likelihood in a log of rests and turns, with their covariance.

Gauss–Newton on `model`. Noise beyond the recording's own is allowed for where chance does not explain it: a bias that
differs from rest to rest (Paule and Mandel 1982), and the variance of the turns and of the parities times χ² per degree
of freedom; of the parities, which hang together within a turn, χ² of their slopes from turn to turn. The answer to
force (g-sensitivity) stays where it is plainly there.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from estimator.hand_turns.model import BIAS, TERMS, ExtraNoise, Moments, Parts, moments, parity_scores, parts, weights
from estimator.hand_turns.recording import RestDirections, TurnedLog
from estimator.hand_turns.start import start
from estimator.least_squares import inverse
from estimator.parameters import LIMIT, PLAUSIBLE
from estimator.session import Array
from estimator.significance import p_value

UNLIKELY = 1e-3
"""p-value below which chance explains nothing, as in `calibration.free.excess`."""
MOST_STEPS = 20
"""Steps of the search; five are usual."""
SMALL = 1e-6
"""Fall of χ² that a step promises from which it moves nothing: a thousandth of a sigma."""
HALVINGS = 6
"""Times that a step which raises χ² is halved."""
ROUNDS = 4
"""Rounds of search and noise: they settle in two or three."""
CONTRADICTED = 10.0
"""Variance of turns or parities, in that of the recording's noise, beyond which the law does not hold (delays between
sensors, a stepping scale, rests that are none) and no covariance can state how far off its answer is. Sound recordings
reach three."""
FEWEST = 5
"""Turns below which nothing is tried: two numbers each, for at least nine unknowns."""


@dataclass(frozen=True, eq=False)
class TurnedGyros:
    """m gyros by rests and turns; readings by the nominal scale."""

    p: Array
    """(m, 7) S, dimensionless, β, rad/s, and G, (rad/s)/(m/s²)."""
    covariance: Array
    """(7 m, 7 m) of p, sensor after sensor; 0 of G where it is left out."""
    by_direction: Array
    """(7 m, 2R) change of p with the directions of the rests, per rad."""
    force: bool
    """Whether G was estimated."""
    residual: Array
    """(R, m) of the rests, rad/s by the nominal scale."""
    sigma: Array
    """(R, m) one sigma of the rests' noise, rad/s by the nominal scale."""
    earth: Array
    """(3,) Earth's rate, rad/s, axes of the block in the first rest."""
    chi2: float
    """χ² of the turns."""
    dof: float
    """Degrees of freedom of the turns."""
    noise: ExtraNoise
    """Noise beyond the recording's own."""

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the covariance; infinite where the recording's own noise explains everything."""
        known = self.noise.turns == 1.0 and self.noise.parities == 1.0 and not self.noise.unrest.any()
        return np.inf if known else max(self.dof, 1.0)


@dataclass(frozen=True)
class ScatteredTurns:
    """Turns that contradict any scales and axes."""

    noise: ExtraNoise
    """Noise that would explain them."""


@dataclass(frozen=True, eq=False)
class TurnSearch:
    """A search and where it stands."""

    log: TurnedLog
    rests: RestDirections
    sums: Moments
    free: NDArray[np.bool_]
    """(P,) unknowns that move."""
    noise: ExtraNoise
    p: Array
    w: Array

    @cached_property
    def here(self) -> Parts:
        """The likelihood where it stands."""
        return parts(self.log, self.rests, self.sums, (self.p, self.w), self.noise)

    @cached_property
    def covariance(self) -> Array:
        """(P, P) of the unknowns that move; 0 of the others."""
        H = np.where(np.outer(self.free, self.free), self.here.H, 0.0)
        return inverse(H, faint=1e-14)

    def with_force(self, used: bool) -> "TurnSearch":
        """The search with or without G."""
        free = self.free.copy()
        free[:-3].reshape(-1, TERMS)[:, BIAS + 1 :] = used
        p = self.p.copy()
        p[:, BIAS + 1 :] *= used
        return replace(self, free=free, p=p)


def calibrate_turned(log: TurnedLog, rests: RestDirections) -> TurnedGyros | ScatteredTurns | None:
    """The gyros of greatest likelihood, or the turns where they contradict any scales and axes; None where they do not
    determine them."""
    m = len(log.axes)
    if np.count_nonzero(log.whole) < FEWEST or m < BIAS or np.linalg.svd(log.axes, compute_uv=False)[-1] < PLAUSIBLE:
        return None
    begin = TurnSearch(
        log, rests, moments(log), np.ones(TERMS * m + 3, bool), ExtraNoise(np.zeros(m)), start(log, rests), np.zeros(3)
    )
    full = settled(begin.with_force(True))
    if isinstance(full, TurnSearch) and answers_to_force(full):
        return judged(full)
    plain = settled((full if isinstance(full, TurnSearch) else begin).with_force(False))
    if isinstance(plain, TurnSearch):
        return judged(plain)
    return plain or (full if isinstance(full, ScatteredTurns) else None)


def judged(search: TurnSearch) -> TurnedGyros | ScatteredTurns:
    """The result of a search, if the turns agree with the law."""
    return result(search) if holds(search.noise) else ScatteredTurns(search.noise)


def holds(noise: ExtraNoise) -> bool:
    """Whether turns and parities agree with the law, but for noise somewhat larger than the recording's."""
    return max(noise.turns, noise.parities) <= CONTRADICTED


def settled(search: TurnSearch) -> TurnSearch | ScatteredTurns | None:
    """The search at its end, under noise that explains what is left; the noise alone where it leaves nothing
    determined, None where nothing is from the start."""
    for _ in range(ROUNDS):
        found = searched(search)
        if found is None or not determined(found):
            return None if holds(search.noise) else ScatteredTurns(search.noise)
        noise = explaining(found)
        if alike(noise, found.noise):
            return found
        search = replace(found, noise=noise)
    return searched(search)


def searched(search: TurnSearch) -> TurnSearch | None:
    """Gauss–Newton; None where it does not settle."""
    for _ in range(MOST_STEPS):
        gradient = np.where(search.free, search.here.gradient, 0.0)
        step = search.covariance @ gradient
        if step @ gradient < SMALL:
            return search
        for halving in range(HALVINGS):
            part = step / 2**halving
            trial = replace(search, p=search.p + part[:-3].reshape(search.p.shape), w=search.w + part[-3:])
            if trial.here.chi2_under(search.here.miss) < search.here.chi2 + SMALL:
                break
        else:
            return search if step @ gradient < 1 else None
        search = trial
    return None


def determined(search: TurnSearch) -> bool:
    """Whether all scales and axes are known better than by a third of what they could be at all."""
    size = np.linalg.norm(search.p[:, :BIAS], axis=1)
    prior = np.zeros((len(size), TERMS))
    prior[:, :BIAS] = (PLAUSIBLE * size[:, None]) ** -2
    H = search.here.H + np.diag(np.append(prior.ravel(), np.zeros(3)))
    free = np.flatnonzero(search.free)
    variance = np.zeros(len(search.free))
    variance[free] = np.diagonal(inverse(H[np.ix_(free, free)], faint=1e-14))
    return bool((variance[:-3].reshape(-1, TERMS)[:, :BIAS].max(axis=1) < (LIMIT * size) ** 2).all())


def explaining(search: TurnSearch) -> ExtraNoise:
    """Noise that explains what the search leaves."""
    here, m = search.here, len(search.p)
    was, dof = search.noise, turns_dof(search)
    turns = here.turns.chi2 * was.turns
    scores, count = slopes_chi2(search)
    taken = 1 + search.free[:TERMS].sum() - BIAS - 1
    return ExtraNoise(
        unrest=np.array([unrest(here.residual[:, i], search.log.rest_sigma[:, i], int(taken)) for i in range(m)]),
        turns=max(1.0, turns / dof) if p_value(turns, dof) < UNLIKELY else 1.0,
        parities=max(1.0, scores / count) if count and p_value(scores, count) < UNLIKELY else 1.0,
    )


def turns_dof(search: TurnSearch) -> float:
    """Degrees of freedom that the turns keep: their number less their share of the unknowns."""
    turns = search.here.turns
    return max(turns.count - float(np.trace(search.covariance @ turns.H)), 1.0)


def slopes_chi2(search: TurnSearch) -> tuple[float, float]:
    """χ² of the slopes of the parities' squares, turn by turn, and the numbers that it is of; 0 of three gyros."""
    log, p = search.log, search.p
    split = weights(p[:, :BIAS], log.noise)
    ratio = float(search.noise.unrest.mean() / log.noise.mean())
    _, slopes, zz = parity_scores(p, split, search.sums.weighed(log.samples, ratio)[log.whole])
    terms = np.flatnonzero(search.free[:TERMS])
    slopes = slopes[:, :, terms]
    H = zz.sum(axis=0)[np.ix_(terms, terms)]
    count = (len(p) - BIAS) * len(terms) * (1 - 1 / len(slopes))
    back = np.linalg.pinv(split.parity, hermitian=True)
    return float(np.einsum("tia,ij,tjb,ab->", slopes, back, slopes, inverse(H, faint=1e-14))), count


def unrest(residual: Array, sigma: Array, taken: int) -> float:
    """Variance from rest to rest that brings χ² of the residuals (R,) to their number less ``taken``; 0 where chance
    explains them. One unit squared."""
    squares, variance = residual**2, sigma**2
    dof = int(np.count_nonzero(np.isfinite(sigma))) - taken
    if dof < 1 or p_value(float((squares / variance).sum()), dof) >= UNLIKELY:
        return 0.0
    high = float(squares.sum()) / dof
    return float(brentq(lambda extra: float((squares / (variance + extra)).sum()) - dof, 0.0, high))


def alike(one: ExtraNoise, other: ExtraNoise) -> bool:
    """Whether two noises differ by less than a tenth, less than their own uncertainty in any recording."""
    first = np.array([one.turns, one.parities, *(one.unrest > 0)])
    second = np.array([other.turns, other.parities, *(other.unrest > 0)])
    near = np.abs(one.unrest - other.unrest) <= 0.1 * one.unrest
    return bool((np.abs(first - second) <= 0.1 * first).all() and near.all())


def answers_to_force(search: TurnSearch) -> bool:
    """Whether the gyros plainly answer to force."""
    force = np.zeros((len(search.p), TERMS), bool)
    force[:, BIAS + 1 :] = True
    at = np.flatnonzero(np.append(force.ravel(), [False] * 3))
    covariance = search.covariance[np.ix_(at, at)]
    G = search.p.ravel()[at]
    return bool(p_value(float(G @ np.linalg.solve(covariance, G)), len(at)) < UNLIKELY)


def result(search: TurnSearch) -> TurnedGyros:
    """Values and covariances of the gyros at the end of a search."""
    here = search.here
    covariance = search.covariance
    gain = -covariance @ here.miss.J.T @ np.linalg.solve(here.miss.variance, here.miss.by_direction)
    return TurnedGyros(
        p=search.p,
        covariance=covariance[:-3, :-3],
        by_direction=gain[:-3],
        force=bool(search.free[BIAS + 1]),
        residual=here.residual,
        sigma=np.sqrt(search.log.rest_sigma**2 + search.noise.unrest),
        earth=search.w,
        chi2=here.turns.chi2 * search.noise.turns,
        dof=turns_dof(search),
        noise=search.noise,
    )
