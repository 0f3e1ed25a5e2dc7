"""Likelihood of gyros in a log of rests and turns, and its derivatives.

Theory
------
A reading, in rad/s by the nominal scale, of m gyros at sample k is

    r_k = S·ω_k + β + G·f_k + n_k

with S = K·E/K_nominal (m, 3), β the offset, G the answer to the specific force f, and noise n of variance Σ.

With N·S = 0 and N·Σ·Nᵀ = 1, the rate ω̂ = W·(r − β − G·f) by weighted least squares and the parities
p = N·(r − β − G·f) are independent and together hold all information of the sample. So the likelihood falls into
three parts:

* **Turns.** ω̂, of variance P = (Sᵀ·Σ⁻¹·S)⁻¹, carries the direction of up from one rest to the next (`integrate`). What
  the next rest shows differs by noise integrated over the turn, and by both directions' own errors, which the turns
  share (`RestDirections.covariance`).
* **Parities**, m − 3 a sample in turns: they need but the sums of products of (r, 1, f).
* **Rests**: mean readings β + G·f + S·w, with the Earth's rate w, constant in space, as three more unknowns whose size
  and, of known latitude, component along up are known beforehand.

With z = (ω, 1, f) and p_i = (S_i, β_i, G_i) of sensor i, all that is needed is ∂ω̂ = −W·∂p·z and ∂p = N·∂p·z: what the
change of the whitening N adds is antisymmetric in the parities and moves no square. The errors of ω̂ as a regressor of
the parities are independent of these, so no gradient is biased by them.
Source: Tedaldi, Pretto, Menegatti, ICRA 2014 (turns by the sum of squares, noise not weighed, three gyros).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import EARTH_RATE
from estimator.arrays import unit
from estimator.hand_turns.integrate import attitude
from estimator.hand_turns.recording import RestDirections, TurnedLog
from estimator.session import Array

TERMS = 7
"""Unknowns of a gyro: S (3), β, G (3)."""
BIAS = 3
"""Place of β among them; before it S, behind it G."""
FIXED = 1e-6
"""Part of the Earth's rate by which its known component may differ: nothing, and yet no hole in an equation."""


@dataclass(frozen=True, eq=False)
class ExtraNoise:
    """Noise beyond the recording's own."""

    unrest: Array
    """(m,) variance of β from rest to rest, (rad/s)²."""
    turns: float = 1.0
    """Factor of the turns' variance."""
    parities: float = 1.0
    """Factor of the parities' variance."""


@dataclass(frozen=True, eq=False)
class Weights:
    """The readings of a sample split into rate and parities."""

    W: Array
    """(3, m)"""
    P: Array
    """(3, 3) variance of the rate, (rad/s)²."""
    parity: Array
    """(m, m) NᵀN, (rad/s)⁻²."""


def weights(S: Array, noise: Array) -> Weights:
    """The split by S (m, 3), dimensionless, under variances (m,), (rad/s)²."""
    sigma = np.sqrt(noise)
    left, size, right = np.linalg.svd(S / sigma[:, None])
    inverse = (right.T / size) @ left[:, :3].T
    N = left[:, 3:].T / sigma
    return Weights(inverse / sigma, (right.T / size**2) @ right, N.T @ N)


@dataclass(frozen=True, eq=False)
class LikelihoodPart:
    """One part of the likelihood at a point: P unknowns, p of all sensors and then w."""

    chi2: float
    count: int
    """Numbers that χ² is of."""
    H: Array
    """(P, P) information."""
    gradient: Array
    """(P,) by which a step is H⁻¹·gradient."""

    def over(self, factor: float) -> "LikelihoodPart":
        """The part under a variance larger by a factor."""
        return LikelihoodPart(self.chi2 / factor, self.count, self.H / factor, self.gradient / factor)


@dataclass(frozen=True, eq=False)
class Moments:
    """Sums over each of T turns of products of v = (r, 1, f), and of v."""

    products: Array
    """(T, m + 4, m + 4)"""
    sums: Array
    """(T, m + 4)"""

    def weighed(self, samples: Array, ratio: float) -> Array:
        """(T, m + 4, m + 4) products, the bias of each turn of ``samples`` (T,) being one of a variance of ``ratio``
        times a sample's."""
        share = ratio / (1 + ratio * samples)
        return self.products - share[:, None, None] * self.sums[:, :, None] * self.sums[:, None]


def moments(log: TurnedLog) -> Moments:
    """The sums over the turns of a log."""
    v = np.column_stack([log.readings, np.ones(len(log.readings)), log.force])
    at = zip(log.stop[:-1].tolist(), log.start[1:].tolist(), strict=True)
    products = np.stack([v[a:b].T @ v[a:b] for a, b in at])
    return Moments(products, log.sums(v))


@dataclass(frozen=True, eq=False)
class Turned:
    """Turns integrated under one set of parameters."""

    turn: Array
    """(R − 1, 3, 3) from the block's axes at the end of each turn to those at its start."""
    at_rest: Array
    """(R, 3, 3) from the block's axes in each rest to those in the first."""
    lean: Array
    """(R, 3, 3) mean turn, over the samples that a rest's direction is the mean of, to the block's axes in the rest."""
    swept: Array
    """(R − 1, 3, 3, 7) Δ·Σ C_k·z_k, C_k to the axes at the start of the turn; rad, s, m/s."""
    spread: Array
    """(R − 1, 3, 3) covariance of the turn by the noise of the samples, rad², axes at the start."""


def turned(log: TurnedLog, p: Array, split: Weights) -> Turned:
    """Integrates all turns; the block does not turn in the rests. p (m, 7)."""
    rate = (log.readings - p[:, BIAS] - log.force @ p[:, BIAS + 1 :].T) @ split.W.T
    rate = np.where(log.turning[:, None], rate, 0.0)
    C = attitude(rate, log.step)
    z = np.column_stack([rate, np.ones(len(rate)), log.force])
    begin = np.swapaxes(C[log.start[:-1]], 1, 2)
    used = np.where(log.turning[:, None, None], C, 0.0)
    sums = log.sums((used[..., None] * z[:, None, None]).reshape(len(C), -1)).reshape(-1, 3, 3, TERMS)
    squares = log.sums((used @ split.P @ np.swapaxes(used, 1, 2)).reshape(len(C), -1)).reshape(-1, 3, 3)
    return Turned(
        turn=begin @ C[log.start[1:]],
        at_rest=np.swapaxes(C[log.start[:1]], 1, 2) @ C[log.start],
        lean=np.swapaxes(C[log.start], 1, 2) @ means(C, *log.seen),
        swept=log.step * np.einsum("tab,tbcz->tacz", begin, sums),
        spread=log.step**2 * begin @ squares @ np.swapaxes(begin, 1, 2),
    )


def means(values: Array, start: Array, stop: Array) -> Array:
    """(R, …) means of values (N, …), of any unit, from ``start`` to ``stop`` (R,)."""
    padded = np.concatenate([values, np.zeros_like(values[:1])])
    sums = np.add.reduceat(padded, np.stack([start, stop], axis=1).ravel(), axis=0)[::2]
    return np.asarray(sums / (stop - start).reshape(-1, *[1] * (values.ndim - 1)))


def upright(rests: RestDirections, lean: Array) -> RestDirections:
    """The directions in the rests themselves, what a mean takes of a turn taken off; ``lean`` as in `Turned`."""
    return replace(rests, up=unit(np.linalg.solve(np.swapaxes(lean, 1, 2), rests.up[..., None])[..., 0]))


@dataclass(frozen=True, eq=False)
class Missed:
    """Directions at the ends of T whole turns, measured less carried over."""

    residual: Array
    """(2T,) rad, along the tangents at the end."""
    J: Array
    """(2T, P) its derivative by the unknowns."""
    by_direction: Array
    """(2T, 2R) its derivative by the directions of the rests."""
    variance: Array
    """(2T, 2T) rad²."""


def missed(log: TurnedLog, rests: RestDirections, went: Turned, W: Array, noise: ExtraNoise) -> Missed:
    """How far the turns miss the next rest; W (3, m) as in `Weights`. The Earth is taken to stand still."""
    R, T = len(rests.up), np.flatnonzero(log.whole)
    back = np.swapaxes(went.turn[T], 1, 2)
    up = (back @ rests.up[T, :, None])[..., 0]
    across = np.swapaxes(rests.tangents[T + 1], 1, 2)
    lever = np.cross(up[:, None], np.eye(3)[None]).swapaxes(1, 2)  # up × each axis, a column each
    to_end = across @ lever @ back
    by_gyro = np.einsum("txa,tabz,bi->txiz", to_end, went.swept[T], W).reshape(2 * len(T), -1)
    earth = log.step * log.samples[T, None, None] * to_end @ np.swapaxes(went.at_rest[T], 1, 2)
    by_direction = np.zeros((len(T), 2, R, 2))
    by_direction[np.arange(len(T)), :, T + 1] = across @ rests.tangents[T + 1]
    by_direction[np.arange(len(T)), :, T] = -across @ back @ rests.tangents[T]
    flat = by_direction.reshape(2 * len(T), 2 * R)
    drift = went.swept[T][..., BIAS] @ W * np.sqrt(noise.unrest)
    own = to_end @ (went.spread[T] + drift @ np.swapaxes(drift, 1, 2)) @ np.swapaxes(to_end, 1, 2)
    variance = flat @ rests.covariance @ flat.T
    places = np.arange(2 * len(T)).reshape(-1, 2)
    variance[places[:, :, None], places[:, None]] += own
    residual = (across @ (rests.up[T + 1] - up)[..., None]).ravel()
    return Missed(residual, np.column_stack([by_gyro, earth.reshape(-1, 3)]), flat, noise.turns * variance)


def of_turns(miss: Missed) -> LikelihoodPart:
    """The turns' part of the likelihood."""
    weighted = np.linalg.solve(miss.variance, np.column_stack([miss.residual, miss.J]))
    chi2 = float(miss.residual @ weighted[:, 0])
    return LikelihoodPart(chi2, len(miss.residual), miss.J.T @ weighted[:, 1:], -miss.J.T @ weighted[:, 0])


def parity_scores(p: Array, split: Weights, products: Array) -> tuple[Array, Array, Array]:
    """Squares of the parities (T,), their slopes (T, m, 7), and Σ z·zᵀ (T, 7, 7), of products (T, m + 4, m + 4)."""
    A = np.column_stack([np.eye(len(p)), -p[:, BIAS:]])
    Z = np.concatenate([split.W @ A, np.eye(len(A.T))[len(p) :]])
    left = A @ products @ A.T
    squares = np.einsum("ij,tij->t", split.parity, left)
    return squares, split.parity @ A @ products @ Z.T, Z @ products @ Z.T


def of_parities(log: TurnedLog, p: Array, sums: Moments, noise: ExtraNoise) -> LikelihoodPart:
    """The parities' part of the likelihood."""
    m, T = len(p), log.whole
    split = weights(p[:, :BIAS], log.noise)
    ratio = float(noise.unrest.mean() / log.noise.mean())
    squares, slopes, zz = parity_scores(p, split, sums.weighed(log.samples, ratio)[T])
    P = TERMS * m + 3
    H, gradient = np.zeros((P, P)), np.zeros(P)
    H[:-3, :-3] = np.kron(split.parity, zz.sum(axis=0))
    gradient[:-3] = slopes.sum(axis=0).ravel()
    return LikelihoodPart(float(squares.sum()), int(log.samples[T].sum()) * (m - 3), H, gradient).over(noise.parities)


def of_rests(
    log: TurnedLog, rests: RestDirections, at_rest: Array, point: tuple[Array, Array], noise: ExtraNoise
) -> LikelihoodPart:
    """The rests' part of the likelihood, with what is known of the Earth's rate w (3,), rad/s, axes of the first.

    at_rest : (R, 3, 3) as in `Turned`; point : as in `parts`.
    """
    p, w = point
    R, m = log.rest.shape
    seen = at_rest @ p[:, :BIAS].T
    residual = rest_residual(log, rests, at_rest, p, w)
    variance = log.rest_sigma**2 + noise.unrest
    J = np.zeros((R, m, TERMS * m + 3))
    own = np.column_stack([np.ones(R), log.gravity * rests.up])
    for i in range(m):
        J[:, i, TERMS * i + BIAS : TERMS * (i + 1)] = own
    J[..., -3:] = np.swapaxes(seen, 1, 2)
    weighted = J / variance[..., None]
    H, gradient = np.einsum("rip,riq->pq", weighted, J), np.einsum("rip,ri->p", weighted, residual)
    mean, information = known_of_earth(log, rests.up[0])
    H[-3:, -3:] += information
    gradient[-3:] += information @ (mean - w)
    return LikelihoodPart(
        float((residual**2 / variance).sum() + (mean - w) @ information @ (mean - w)), R * m, H, gradient
    )


def rest_residual(log: TurnedLog, rests: RestDirections, at_rest: Array, p: Array, w: Array) -> Array:
    """(R, m) mean readings at rest less the model's, rad/s."""
    earth = np.swapaxes(at_rest, 1, 2) @ w
    return np.asarray(log.rest - p[:, BIAS] - log.gravity * rests.up @ p[:, BIAS + 1 :].T - earth @ p[:, :BIAS].T)


def known_of_earth(log: TurnedLog, up: Array) -> tuple[Array, Array]:
    """Mean (3,), rad/s, and information (3, 3) beforehand of the Earth's rate, where ``up`` (3,) is up."""
    if log.latitude is None:
        return np.zeros(3), 3 * np.eye(3) / EARTH_RATE**2
    along, level = np.outer(up, up), np.cos(log.latitude) ** 2 / 2 + FIXED**2
    information = along / FIXED**2 + (np.eye(3) - along) / level
    return EARTH_RATE * np.sin(log.latitude) * up, information / EARTH_RATE**2


@dataclass(frozen=True, eq=False)
class Parts:
    """The likelihood's parts at one point."""

    rests: LikelihoodPart
    turns: LikelihoodPart
    parities: LikelihoodPart
    miss: Missed
    residual: Array
    """(R, m) of the rests, rad/s."""

    @property
    def chi2(self) -> float:
        """χ² of all three."""
        return self.chi2_under(self.miss)

    def chi2_under(self, other: Missed) -> float:
        """χ² of all three under the variance of the turns at another point, which a step may not change to its gain."""
        turns = self.miss.residual @ np.linalg.solve(other.variance, self.miss.residual)
        return self.rests.chi2 + float(turns) + self.parities.chi2

    @property
    def H(self) -> Array:
        """(P, P) information of all three."""
        return self.rests.H + self.turns.H + self.parities.H

    @property
    def gradient(self) -> Array:
        """(P,) of all three."""
        return self.rests.gradient + self.turns.gradient + self.parities.gradient


def parts(log: TurnedLog, rests: RestDirections, sums: Moments, point: tuple[Array, Array], noise: ExtraNoise) -> Parts:
    """Everything at a ``point``: p (m, 7), dimensionless, rad/s and (rad/s)/(m/s²), and w (3,), rad/s."""
    p, w = point
    split = weights(p[:, :BIAS], log.noise)
    went = turned(log, p, split)
    rests = upright(rests, went.lean)
    still = missed(log, rests, went, split.W, noise)
    miss = replace(still, residual=still.residual + still.J[:, -3:] @ w)
    return Parts(
        rests=of_rests(log, rests, went.at_rest, point, noise),
        turns=of_turns(miss),
        parities=of_parities(log, p, sums, noise),
        miss=miss,
        residual=rest_residual(log, rests, went.at_rest, p, w),
    )
