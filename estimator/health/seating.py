"""The scatter with which blocks are seated on every stand, by restricted maximum likelihood.

What session i of unit u, on stand s, shows of a block's pose (of its scales) is

    z_ui = r_u + f_us + a_ui + Σ_e D_ui,e·δ_e + ε_ui,    a ~ N(0, τ²_us·1), f ~ N(0, ω²_s·1), ε ~ N(0, C_ui)

r_u is where the unit's reference happened to be and is free; a is how the block was seated this time, f how this block
always sits in this fixture, C what the session itself is uncertain of; δ_e are the events of `stand_events`, such as a
stand that turned. With V_u the covariance of a unit's sessions, X a column of ones and P = V⁻¹ − V⁻¹X(XᵀV⁻¹X)⁻¹XᵀV⁻¹
per unit, δ is the generalised least squares estimate J⁻¹DᵀPz with the covariance J⁻¹ = (DᵀPD)⁻¹.

A variance θ with the pattern K (∂V/∂θ) is estimated by majorise–minimise steps on the restricted likelihood (Zhou, Hu,
Qiao, Cho 2019, J. Comput. Graph. Stat. 28, 350), A = tr(P*K), B = θ²·rᵀKr, r = P*z, P* being P with the events taken
out: A·θ + B/θ falls at every step. Units differ in how well they fit a fixture, and most have few sessions: empirical
Bayes. Given its stand's typical σ²_s, τ²_us is worth ν more readings of that size (inverse gamma), so that

    A·θ² + ν·θ − (B + ν·σ²_s) = 0;

σ²_s is the stand's own maximum given its units, and is drawn in the same way towards the typical one of all stands,
which stands for a stand that is new. ν says how alike units are seated. It is found as Smyth (2004, Stat. Appl. Genet.
Mol. Biol. 3, 3) does for variances of many genes: with τ² alike on a stand, q = Σ|r|²/tr P of a unit on it would be
χ²/d with d degrees of freedom; what ln q scatters more than ψ′(d/2) is ψ′(ν/2). Values are in rad (turns) or relative
(scales), covariances in rad² or relative².
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq
from scipy.special import digamma, polygamma

from estimator.session import Array

LEAST_ALIKE, MOST_ALIKE = 2.0, 60.0
"""Bounds of ν: with fewer a unit seen twice would look perfectly seated by chance, and beyond it no weight changes."""
STAND_PRIOR = 4.0
"""Readings that what is typical of all stands counts for in one: a session and a third, less than any stand has."""
FEWEST_CELLS = 6
"""Units on stands that can say how alike they are."""
ROUNDS, SETTLED = 40, 0.04
"""Steps at most; relative change of every variance below which they end."""
STRIDE = 1.7
"""Steps are this much longer, in the logarithm: majorise–minimise alone takes half of the way."""
NOTHING = 1e-3
"""Least variance, part of the sessions' own: less changes no weight."""


@dataclass(frozen=True, eq=False)
class SeatedUnits:
    """Units with about equally many sessions, filled up with empty places to n each."""

    value: Array
    """(u, n, k) rad or relative."""
    noise: Array
    """(u, n, k, k) noise covariance of each session alone, rad² or relative²; the unit matrix where there is none."""
    time: Array
    """(u, n) years."""
    unit: Array
    """(u,) number of each unit."""
    stand: Array
    """(u, n) number of the stand; −1 in an empty place."""
    cell: Array
    """(u, n) number of the pair of unit and stand; −1 in an empty place."""

    @property
    def there(self) -> Array:
        """(u, n) bool; where there is a session."""
        return self.stand >= 0

    @property
    def same(self) -> Array:
        """(u, n, n) 1 for two sessions of one unit on one stand, otherwise 0."""
        return (self.cell[:, :, None] == self.cell[:, None, :]) * (self.there[:, :, None] & self.there[:, None, :])


@dataclass(frozen=True, eq=False)
class SeatingScatter:
    """Variances per component, rad² or relative²."""

    cell: Array
    """(c,) τ² of a mounting, of every pair of unit and stand."""
    stand: Array
    """(s,) σ², what is typical of each stand."""
    fixed: Array
    """(s,) ω² of how a block always sits."""
    alike: float
    """ν."""


@dataclass(frozen=True, eq=False)
class Weighted:
    """Units with what the variances make of them."""

    units: SeatedUnits
    precision: Array
    """(u, n, k, n, k) P, the inverse of a covariance."""
    column: Array
    """(u, n, e) D."""
    seen: Array
    """(u, n, k, e, k) P·D."""
    rest: Array
    """(u, n, k) r = P·(z − D·δ)."""


@dataclass(frozen=True, eq=False)
class Seating:
    """The fit at given events."""

    parts: tuple[Weighted, ...]
    scatter: SeatingScatter
    stand_of: Array
    """(c,) number of each cell's stand."""
    value: Array
    """(e, k) δ, rad or relative."""
    covariance: Array
    """(e, k, e, k) covariance of δ, rad² or relative²."""


def seated(
    groups: Sequence[SeatedUnits], columns: Sequence[Array], stand_of: Array, start: SeatingScatter | None = None
) -> Seating:
    """Variances and events together.

    Parameters
    ----------
    groups : all units.
    columns : D of each group, (u, n, e), 1 where an event acts.
    stand_of : (c,) number of the stand of every pair of unit and stand, dimensionless.
    start : variances to begin with.
    """
    scatter = start
    if scatter is None:
        alike = _settled(groups, columns, stand_of, _start(groups, stand_of))
        scatter = replace(alike.scatter, alike=_alikeness(alike))
    return _settled(groups, columns, stand_of, scatter)


def _settled(
    groups: Sequence[SeatedUnits], columns: Sequence[Array], stand_of: Array, scatter: SeatingScatter
) -> Seating:
    """Steps until no variance changes any more."""
    least = NOTHING * _typical(groups)
    for _ in range(ROUNDS):
        new = _step(_at(groups, columns, stand_of, scatter), least)
        moved = max(float(np.abs(np.log(a / b)).max()) for a, b in zip(_flat(new), _flat(scatter), strict=True))
        scatter = new
        if moved < SETTLED:
            break
    return _at(groups, columns, stand_of, scatter)


def _alikeness(seating: Seating) -> float:
    """ν, from units that are all taken to be seated alike on a stand."""
    sums = _sums(seating)[0]
    dof = freedoms(seating)
    some = (dof >= 1) & (sums.square > 0) & (sums.trace > 0)
    if some.sum() < FEWEST_CELLS:
        return LEAST_ALIKE
    half = dof[some] / 2
    spread = np.log(sums.square[some] / sums.trace[some]) - digamma(half) + np.log(half)
    stand = seating.stand_of[some]
    count = np.maximum(np.bincount(stand), 1)
    rest = spread - (np.bincount(stand, weights=spread) / count)[stand]
    free = max(len(rest) - len(np.unique(stand)), 1)
    excess = float((rest**2).sum() / free - polygamma(1, half).mean())
    ends = [float(polygamma(1, nu / 2)) for nu in (MOST_ALIKE, LEAST_ALIKE)]
    if not ends[0] < excess < ends[1]:
        return MOST_ALIKE if excess <= ends[0] else LEAST_ALIKE
    return float(brentq(lambda nu: float(polygamma(1, nu / 2)) - excess, LEAST_ALIKE, MOST_ALIKE))


def freedoms(seating: Seating) -> Array:
    """(c,) degrees of freedom that the sessions of each unit on each stand give its τ²."""
    cells = len(seating.stand_of)
    known = np.zeros(cells)
    for part in seating.parts:
        there = part.units.there
        energy = ((part.precision**2).sum(axis=(2, 4)) * part.units.same).sum(axis=2)
        known += np.bincount(part.units.cell[there], energy[there], cells)
    return seating.scatter.cell**2 * known


def _flat(scatter: SeatingScatter) -> tuple[Array, Array]:
    """(c,) and (s,): the variances that weigh."""
    return scatter.cell, scatter.fixed


def _typical(groups: Sequence[SeatedUnits]) -> float:
    """The sessions' own variance, per component."""
    diagonals = [np.diagonal(g.noise[g.there], axis1=1, axis2=2) for g in groups]
    return float(np.median(np.concatenate(diagonals)))


def _start(groups: Sequence[SeatedUnits], stand_of: Array) -> SeatingScatter:
    """All that units scatter about their own means is seating, for a start."""
    squares, count = 0.0, 0
    for g in groups:
        mean = g.value.sum(axis=1) / g.there.sum(axis=1)[:, None]
        rest = (g.value - mean[:, None])[g.there]
        squares, count = squares + float((rest**2).sum()), count + rest.size
    level, stands = max(squares / max(count, 1), NOTHING * _typical(groups)), int(stand_of.max()) + 1
    return SeatingScatter(np.full(len(stand_of), level), np.full(stands, level), np.full(stands, level), MOST_ALIKE)


def _at(groups: Sequence[SeatedUnits], columns: Sequence[Array], stand_of: Array, scatter: SeatingScatter) -> Seating:
    """Generalised least squares at given variances."""
    k, e = groups[0].value.shape[2], columns[0].shape[2]
    made, normal, pull = [], np.zeros((e, k, e, k)), np.zeros((e, k))
    for g, column in zip(groups, columns, strict=True):
        p = _precision(g, scatter)
        seen = np.einsum("uiajb,uje->uiaeb", p, column, optimize=True)
        raw = np.einsum("uiajb,ujb->uia", p, g.value, optimize=True)
        normal += np.einsum("uid,uiaeb->daeb", column, seen, optimize=True)
        pull += np.einsum("uid,uia->da", column, raw, optimize=True)
        made.append((g, p, column, seen, raw))
    covariance = np.linalg.pinv(normal.reshape(e * k, e * k), hermitian=True)
    value = (covariance @ pull.ravel()).reshape(e, k)
    parts = tuple(
        Weighted(g, p, column, seen, raw - np.einsum("uiaeb,eb->uia", seen, value)) for g, p, column, seen, raw in made
    )
    return Seating(parts, scatter, stand_of, value, covariance.reshape(e, k, e, k))


def _precision(g: SeatedUnits, scatter: SeatingScatter) -> Array:
    """(u, n, k, n, k) P, the inverse of a covariance."""
    u, n, k = g.value.shape
    identity = np.eye(k)
    noise = g.noise + np.where(g.there, scatter.cell[g.cell], 0.0)[..., None, None] * identity
    v = (g.same * scatter.fixed[g.stand][:, :, None])[:, :, None, :, None] * identity[:, None, :]
    v[:, np.arange(n), :, np.arange(n), :] += np.swapaxes(noise, 0, 1)
    w = np.linalg.inv(v.reshape(u, n * k, n * k)).reshape(u, n, k, n, k)
    wx = np.einsum("uiajb,uj->uiab", w, g.there.astype(float))
    mean = np.linalg.inv(np.einsum("uiab,ui->uab", wx, g.there.astype(float)))
    taken: Array = w - np.einsum("uiab,ubc,ujdc->uiajd", wx, mean, wx, optimize=True)
    return taken


@dataclass(frozen=True, eq=False)
class _SeatingSums:
    """The sums A and B/θ² that a step needs for every variance."""

    trace: Array
    square: Array


def _step(seating: Seating, least: float) -> SeatingScatter:
    """One step of all variances."""
    cell, fixed = _sums(seating)
    old = seating.scatter
    typical = old.stand[seating.stand_of]
    tau = _longer(old.cell, _root(old.cell, cell, old.alike, typical), least)
    pool = float(np.exp(np.mean(np.log(old.fixed))))
    omega = _longer(old.fixed, _root(old.fixed, fixed, STAND_PRIOR, np.full_like(old.fixed, pool)), least)
    return SeatingScatter(tau, _stands(tau, seating.stand_of, old), omega, old.alike)


def _root(theta: Array, sums: _SeatingSums, prior: float, typical: Array) -> Array:
    """The positive root of A·θ² + ν·θ − (B + ν·σ²)."""
    a, c = np.maximum(sums.trace, 0.0), theta**2 * sums.square + prior * typical
    return 2 * c / (prior + np.sqrt(prior**2 + 4 * a * c))


def _longer(old: Array, new: Array, least: float) -> Array:
    """A step of `STRIDE` in the logarithm."""
    return np.maximum(old * (new / old) ** STRIDE, least)


def _stands(tau: Array, stand_of: Array, old: SeatingScatter) -> Array:
    """(s,) the maximum of each stand's typical variance, given its units and the typical one of all stands."""
    pool, stands = float(np.exp(np.mean(np.log(old.stand)))), len(old.stand)
    count = old.alike * np.bincount(stand_of, minlength=stands)
    inverse = old.alike * np.bincount(stand_of, weights=1 / tau, minlength=stands)
    half = (count - STAND_PRIOR) / 2
    return np.asarray((half + np.sqrt(half**2 + inverse * STAND_PRIOR * pool)) / inverse)


def _sums(seating: Seating) -> tuple[_SeatingSums, _SeatingSums]:
    """A and B/θ² of every pair of unit and stand, and of every stand."""
    cells, stands = len(seating.stand_of), len(seating.scatter.fixed)
    by_cell, fixed = np.zeros((2, cells)), np.zeros((2, stands))
    for part in seating.parts:
        there, same = part.units.there, part.units.same
        blocks = np.einsum("uiaja->uij", part.precision)
        taken = _taken(part.seen, part.seen, seating.covariance)
        together = np.einsum("uij,ujaeb->uiaeb", same, part.seen)
        fixed_trace = (blocks * same).sum(axis=2) - _taken(part.seen, together, seating.covariance)
        fixed_square = np.einsum("uia,uij,uja->ui", part.rest, same, part.rest, optimize=True)
        trace, square = np.einsum("uii->ui", blocks) - taken, (part.rest**2).sum(axis=2)
        by_cell += _binned(part.units.cell[there], (trace[there], square[there]), cells)
        fixed += _binned(part.units.stand[there], (fixed_trace[there], fixed_square[there]), stands)
    return _SeatingSums(*by_cell), _SeatingSums(*fixed)


def _taken(first: Array, second: Array, covariance: Array) -> Array:
    """(u, n) reductions of the traces of P by the events, unit of P; both (u, n, k, e, k)."""
    return np.asarray(np.einsum("uiaeb,ebfc,uiafc->ui", first, covariance, second, optimize=True))


def _binned(place: Array, weights: tuple[Array, Array], size: int) -> Array:
    """(2, size) sums by place."""
    return np.stack([np.bincount(place, weights=w, minlength=size) for w in weights])
