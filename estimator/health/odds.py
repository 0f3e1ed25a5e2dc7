"""The odds of any change against none, and how rarely they are as high by chance.

Bayes factor of a fixed mixture of changes against the null, whose whitened readings z̃, freed of the base, are N(0, P):

    B(z̃) = Σ_h w_h·exp(s_h²x_h²/(2(1 + s_h²S_h)))/√(1 + s_h²S_h) + Σ_q w_q·N(z̃; 0, P + q²W̃)/N(z̃; 0, P)

over jumps, drifts and aging at every place and size, and over walks; W̃ = P L⁻¹WL⁻ᵀP. Of all rules with as many false
alarms this finds most of the mixture (Neyman & Pearson). Its chance of reaching b where nothing happens is, by drawing
half of R histories from the null and half from the mixture (defensive importance sampling, Hesterberg 1995),

    p = 1/R·Σ 1[B_r ≥ b]/(½ + ½B_r),

whose terms are at most 2/b: the relative error is small however small the chance is. It corrects for all kinds, sizes
and times that were tried, and never exceeds 1/b (Markov). The draws are fixed.

Where errors may have tails (`tails`), the chance is that of each ν by its weight. A third of the draws is then of
Student's law t, a third of the same with one session `WILD` times as wide, its density w in place of t, a third of the
mixture above:

    p = 1/R·Σ 1[B_r ≥ b]·3/(1 + m_r + B_r·N(z_r)/t(z_r)),    m the mean of w(z_i)/t(z_i) over all sessions
"""

from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.health.error_laws import FREEDOMS, NORMAL, drawn, log_density
from estimator.health.fits import PART_KINDS, PART_SIZES, Fits
from estimator.health.shapes import Kind
from estimator.session import Array

DRAWS = 1000
"""The chance is right to a few percent of itself."""
FEW, PLAIN = 200, 0.2
"""Draws that are enough for a chance above it, which decides nothing: it is right to a seventh of itself."""
SEED = 1995
"""Seed of the draws, fixed so that the same history always has the same p-value."""
WILD = 6.0
"""Factor by which a wild session's errors are widened: about one session in several thousand is as far out."""
FELT = 1e-4
"""Weight of a law of errors below which it changes no p-value that a level asks for."""
COMMON = 0.1
"""p-value of mostly normal errors above which tails change nothing that matters: outliers are rare."""
WANDERS = np.array([0.06, 0.12, 0.25, 0.5])
"""(4,) T a root year, beyond what the type does anyway."""
SHARES = {Kind.JUMP: 1 / 3, Kind.LATE: 1 / 9, Kind.START: 1 / 9, Kind.AGING: 1 / 9, Kind.WALK: 1 / 3}
"""Shares of the mixture. A jump, a drift and a walk have equal parts, since rare changes matter no less; the three
sorts of drift, which look much alike, share one part.
"""


@dataclass(frozen=True, eq=False)
class Odds:
    """The odds of a change, in total and by kind, with their p-value."""

    total: float
    """log B"""
    of_kind: dict[Kind, float]
    """log of each kind's part of B."""
    p_value: float


@dataclass(frozen=True, eq=False)
class Mixture:
    """The parts of B that depend on the schedule alone; k components, G hypotheses that have a shape."""

    unit: Array
    """(k, n, H) whitened shapes of length one; 0 where a shape leaves no trace."""
    shape: Array
    """(G,) place of the shape."""
    kind: Array
    """(G,) `Kind`."""
    share: Array
    """(G,) w_h"""
    strength: Array
    """(k, G) s_h²S_h, dimensionless."""
    modes: Array
    """(k, n, n) eigenvectors of W̃, its own space only."""
    walked: Array
    """(k, n) eigenvalues of W̃, per T²."""

    def log_parts(self, z: Array) -> tuple[Array, Array]:
        """(R, G) and (R, 4) logs of the terms of B, of R whitened histories (R, k, n)."""
        by_component = z.swapaxes(0, 1)
        score2 = ((by_component @ self.unit) ** 2)[..., self.shape]
        gain = self.strength / (1 + self.strength)
        shaped = 0.5 * (score2 * gain[:, None, :]).sum(axis=0) - 0.5 * np.log1p(self.strength).sum(axis=0)
        ratio = WANDERS[:, None, None] ** 2 * self.walked
        turned = ((by_component @ self.modes) ** 2).swapaxes(0, 1).reshape(len(z), -1)
        held = (ratio / (1 + ratio)).reshape(len(WANDERS), -1)
        wandered = 0.5 * turned @ held.T - 0.5 * np.log1p(ratio).sum(axis=(1, 2))
        return shaped + np.log(self.share), wandered + np.log(SHARES[Kind.WALK] / len(WANDERS))

    def log_odds(self, z: Array) -> Array:
        """(R,) log B."""
        logs = np.concatenate(self.log_parts(z), axis=1)
        largest = logs.max(axis=1)
        return np.asarray(largest + np.log(np.exp(logs - largest[:, None]).sum(axis=1)))

    def drawn(self, rng: np.random.Generator, runs: int) -> Array:
        """(runs, k, n) histories of the mixture; beyond z̃'s own space they hold noise that nothing looks at."""
        z = rng.standard_normal((runs, *self.unit.shape[:2]))
        chances = np.concatenate([self.share, np.full(len(WANDERS), SHARES[Kind.WALK] / len(WANDERS))])
        picked = rng.choice(len(chances), runs, p=chances / chances.sum())
        rows = np.flatnonzero(picked < len(self.share))
        size = np.sqrt(self.strength[:, picked[rows]].T) * rng.standard_normal((len(rows), len(self.unit)))
        z[rows] += size[:, :, None] * self.unit[:, :, self.shape[picked[rows]]].transpose(2, 0, 1)
        rows = np.flatnonzero(picked >= len(self.share))
        wide = WANDERS[picked[rows] - len(self.share)][:, None, None] * np.sqrt(self.walked)
        z[rows] += np.einsum("rkm,knm->rkn", wide * rng.standard_normal(wide.shape), self.modes)
        return z


def mixture(null: Fits, time: Array, visible: Array) -> Mixture:
    """Builds the mixture from the fits at the single walk of the null; ``visible`` (H,) bool marks the shapes that
    leave a trace.
    """
    shape, kind, share, size2 = [], [], [], []
    family, information = null.family, null.information[0]
    for place in np.flatnonzero(np.isin(PART_KINDS, list(SHARES))):
        same_kind = PART_KINDS[place] == PART_KINDS
        members = np.flatnonzero((family.kind == PART_KINDS[place]) & visible)
        sizes = int(np.count_nonzero(same_kind))
        shape.append(members)
        kind.append(np.full(len(members), PART_KINDS[place]))
        share.append(SHARES[Kind(int(PART_KINDS[place]))] * family.share[members] / sizes)
        size2.append(np.full(len(members), PART_SIZES[place] ** 2))
    places = np.concatenate(shape)
    length = np.sqrt(np.where(visible, information, np.inf))
    values, vectors = _modes(null, time)
    return Mixture(
        unit=null.shapes[0] / length[:, None, :],
        shape=places,
        kind=np.concatenate(kind),
        share=np.concatenate(share),
        strength=information[:, places] * np.concatenate(size2),
        modes=vectors,
        walked=values,
    )


def _modes(null: Fits, time: Array) -> tuple[Array, Array]:
    """(k, n) eigenvalues, per T², and (k, n, n) eigenvectors of W̃."""
    root, frame = null.root[0], null.frame[0]
    half = np.linalg.solve(root, np.broadcast_to(np.minimum.outer(time, time), root.shape))
    whole = np.linalg.solve(root, half.swapaxes(1, 2))
    free = np.eye(len(time)) - frame @ frame.swapaxes(1, 2)
    values, vectors = eigh(free @ whole @ free)
    return np.maximum(values, 0.0), vectors


def odds(mixed: Mixture, z: Array, tails: Array = NORMAL) -> Odds:
    """The odds for one whitened history (k, n), freed of the base; ``tails`` (4,) the weight of each of `FREEDOMS`."""
    shaped, wandered = (part[0] for part in mixed.log_parts(z[None]))
    b = float(np.logaddexp(np.logaddexp.reduce(shaped), np.logaddexp.reduce(wandered)))
    kinds: dict[Kind, float] = {kind: _sum(shaped[mixed.kind == kind]) for kind in SHARES}
    kinds[Kind.WALK] = _sum(wandered)
    return Odds(b, kinds, _chance(mixed, z.shape, b, tails))


def _chance(mixed: Mixture, shape: tuple[int, ...], b: float, tails: Array) -> float:
    """p over all laws of errors."""
    normal = _law_chance(mixed, shape, b, np.inf) if tails[0] > FELT else 0.0
    if tails[0] > 0.5 and normal > COMMON:
        return normal
    heavy = [(float(tails[i]), float(FREEDOMS[i])) for i in np.flatnonzero(tails > FELT) if np.isfinite(FREEDOMS[i])]
    rest = sum(weight * _law_chance(mixed, shape, b, freedom) for weight, freedom in heavy)
    return min(float(tails[0]) * normal + rest, 1.0)


def _law_chance(mixed: Mixture, shape: tuple[int, ...], b: float, freedom: float) -> float:
    """p where errors are of one law, from as many draws as it needs."""
    rough = _by_law(mixed, shape, b, freedom, FEW)
    return rough if rough > PLAIN else _by_law(mixed, shape, b, freedom, DRAWS)


def _by_law(mixed: Mixture, shape: tuple[int, ...], b: float, freedom: float, draws: int) -> float:
    return _by_chance(mixed, shape, b, draws) if np.isinf(freedom) else _by_tails(mixed, shape, b, freedom, draws)


def _by_chance(mixed: Mixture, shape: tuple[int, ...], b: float, draws: int) -> float:
    """p where errors are normal, from so many ``draws``."""
    rng = np.random.default_rng(SEED)
    nothing = rng.standard_normal((draws // 2, *shape))
    reached = mixed.log_odds(np.concatenate([nothing, mixed.drawn(rng, draws // 2)]))
    beyond = reached[reached >= b - 1e-9]
    bound = float(np.exp(-max(b, 0.0)))
    return min(float(np.sum(2 / (1 + np.exp(np.minimum(beyond, 700.0))))) / draws, bound) if beyond.size else bound


def _by_tails(mixed: Mixture, shape: tuple[int, ...], b: float, freedom: float, draws: int) -> float:
    """p where they are Student's."""
    rng = np.random.default_rng(SEED)
    runs = draws // 3
    plain, wild = drawn(freedom, (runs, *shape), rng), drawn(freedom, (runs, *shape), rng)
    flat = wild.reshape(runs, -1)
    flat[np.arange(runs), rng.integers(flat.shape[1], size=runs)] *= WILD
    z = np.concatenate([plain, flat.reshape(wild.shape), mixed.drawn(rng, runs)])
    reached = mixed.log_odds(z)
    student = log_density(z, freedom)
    wider = np.exp(log_density(z / WILD, freedom) - np.log(WILD) - student).mean(axis=(1, 2))
    changed = reached + (log_density(z, np.inf) - student).sum(axis=(1, 2))
    return float(np.mean((reached >= b - 1e-9) * 3 / (1 + wider + np.exp(np.minimum(changed, 700.0)))))


def _sum(logs: Array) -> float:
    return float(np.logaddexp.reduce(logs)) if logs.size else -np.inf
