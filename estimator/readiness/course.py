"""The slow course of a record, and what it is still going to do.

Model of the means y_k of a sensor at t_k, T s in all:

    y_k = c_p + d·t_k/T + Σ_j a_j·(1 − e^{−t_k/τ_j}) + w(t_k) + ε_k,    Var ε_k = σ²/n_k,    Var w(t) = ρ·σ²·t/T

c_p of each position, a steady drift or none, up to two first-order settlings, a random walk and white noise. ρ and the
τ stand on grids; given them, the model is linear with a known shape of covariance, so with Gaussian priors of d and a
in units of σ its posterior is Student's and its evidence closed (Zellner 1971, An Introduction to Bayesian Inference in
Econometrics, ch. 3; Gelman et al. 2013, Bayesian Data Analysis, ch. 14):

    ln p(y) = −½ ln|V| − ½ ln|ZᵀV⁻¹Z| + ½ ln|Λ| − ½ ln|XᵀPX + Λ| − ½ (n − p)·ln S + const,

Z the positions' constants, P = V⁻¹ projected free of them, Λ the priors' precision in units of σ², S the residual sum
of squares. Cells are weighed by their evidence; numbers of settlings, drift or none, walk or none are equally likely a
priori, and the priors of d and a are ten times the record's range. Two settlings of neighbouring τ act as one between
them, so that the grid may be coarse.
"""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from estimator.session import Array

TAUS = 60.0 * 1.3 ** np.arange(20)
"""s, one minute to two and a half hours: electronics settle within minutes, housings and fixtures within hours."""
PAIRS = np.array([(0, 0), *((j, j) for j in range(len(TAUS))), *combinations(range(len(TAUS)), 2)])
"""Numbers of the τ: none, which uses neither, then one, which uses the first, then two."""
SETTLINGS = np.tile(PAIRS, (2, 1))
"""(J, 2) numbers of the τ of every shape of the course: first without a steady drift, then with one."""
STEADY = np.repeat([0, 1], len(PAIRS))
"""(J,) whether there is a steady drift."""
USED = np.tile([0] + [1] * len(TAUS) + [2] * (len(PAIRS) - len(TAUS) - 1), 2)
"""(J,) number of settlings of each shape."""
PRIOR = np.log(1 / 3 / np.bincount(USED)[USED])
"""(J,) ln prior chance of each shape: none, one and two settlings are as likely beforehand, and so is a steady drift or
none.
"""
WALKS = np.concatenate([[0.0], np.logspace(-3, 3, 7)])
"""ρ, the walk's variance over the record in variances of one mean: from far below what a hundred means show to where
white noise no longer matters."""
NO_WALK = 0.5
"""Prior chance that there is no walk; the other half is shared by its sizes."""
WIDE = 10.0
"""Ranges of the record, and amounts allowed, that one sigma of the priors of d and a is wide: so that they say nothing
but that the future is no wholly other thing."""


@dataclass(frozen=True, eq=False)
class SettlingCourse:
    """The posterior of one sensor, on C cells of ρ and τ."""

    span: float
    """T, s."""
    weight: Array
    """(C,) probability of each cell."""
    walk: Array
    """(C,) ρ."""
    tau: Array
    """(C, 2) s."""
    mean: Array
    """(C, 3) means of d and both a, m/s² or rad/s; zero for what is not in the shape."""
    root: Array
    """(C, 3, 3) lower root of their covariance over σ², dimensionless."""
    scatter: Array
    """(C,) sum of squares that is left, (m/s²)² or (rad/s)²."""
    freedom: int
    """Degrees of freedom of the scatter."""


def courses(time: Array, value: Array, place: Array, count: Array, wide: Array) -> tuple[SettlingCourse, ...]:
    """The courses of every column of ``value`` (n, m), m/s² or rad/s, at ``time`` (n,), s; ``place`` (n,) numbers of
    positions, ``count`` (n,) samples; ``wide`` (m,) one sigma of the priors of d and a, m/s² or rad/s.
    """
    t = time - time[0]
    span = float(t[-1])
    numbers, members = np.unique(place, return_inverse=True)
    Z = (members[:, None] == np.arange(len(numbers))).astype(float)
    noise = np.maximum(first_scatter(value, place), 1e-6 * wide)  # a prior 10⁶ σ wide is flat
    shrink = (noise / wide) ** 2
    X = np.column_stack([t / span, 1 - np.exp(-t[:, None] / TAUS)])
    pieces = [_cells(_whitened(t, count, walk, Z, X, value), shrink) for walk in WALKS]
    freedom = len(t) - Z.shape[1]
    prior = np.where(WALKS > 0, np.log((1 - NO_WALK) / (len(WALKS) - 1)), np.log(NO_WALK))
    evidence = np.concatenate([p.evidence + q for p, q in zip(pieces, prior, strict=True)])
    evidence -= evidence.max(axis=0)
    weight = np.exp(evidence)
    weight /= weight.sum(axis=0)
    mean, root, scatter = (np.concatenate([getattr(p, name) for p in pieces]) for name in ("mean", "root", "scatter"))
    walk, tau = np.repeat(WALKS, len(SETTLINGS)), np.tile(TAUS[SETTLINGS], (len(WALKS), 1))
    return tuple(
        SettlingCourse(span, weight[:, i], walk, tau, mean[:, i], root[:, i], scatter[:, i], freedom)
        for i in range(value.shape[1])
    )


def first_scatter(value: Array, place: Array) -> Array:
    """(m,) sd of a mean by the changes between neighbours of one position, the unit of ``value`` (n, m)."""
    steps = np.diff(value, axis=0)[np.diff(place) == 0]
    return np.asarray(np.sqrt(np.mean(steps**2, axis=0) / 2)) if len(steps) else np.zeros(value.shape[1])


@dataclass(frozen=True, eq=False)
class _White:
    """Columns in standard errors, freed of the positions' own constants; half log determinants of what was done."""

    X: Array
    y: Array
    lost: float
    freedom: int


def _whitened(t: Array, count: Array, walk: float, Z: Array, X: Array, value: Array) -> _White:
    V = np.diag(np.median(count) / count) + walk * np.minimum.outer(t, t) / t[-1]
    L = cholesky(V, lower=True)
    white = solve_triangular(L, np.hstack([Z, X, value]), lower=True)
    p, q = Z.shape[1], X.shape[1]
    Q, R = np.linalg.qr(white[:, :p])
    rest = white[:, p:] - Q @ (Q.T @ white[:, p:])
    lost = np.log(np.diag(L)).sum() + np.log(np.abs(np.diag(R))).sum()
    return _White(rest[:, :q], rest[:, q:], float(lost), len(t) - p)


@dataclass(frozen=True, eq=False)
class _Cells:
    """The cells of one ρ: every settling (first axis) and sensor (second)."""

    evidence: Array
    mean: Array
    root: Array
    scatter: Array


def _cells(white: _White, shrink: Array) -> _Cells:
    gram, toward = white.X.T @ white.X, white.X.T @ white.y
    used = np.column_stack([np.zeros(len(SETTLINGS), dtype=int), SETTLINGS + 1])
    there = (np.arange(3) <= USED[:, None]).astype(float)
    there[:, 0] = STEADY
    A = (gram[used[:, :, None], used[:, None, :]] * there[:, :, None] * there[:, None, :])[:, None]
    A = A + shrink[:, None, None] * np.eye(3)
    b = (toward[used] * there[:, :, None]).transpose(0, 2, 1)
    mean = np.linalg.solve(A, b[..., None])[..., 0]
    energy = (white.y**2).sum(axis=0)
    scatter = np.maximum(energy - (mean * b).sum(axis=-1), 1e-12 * energy + np.finfo(float).tiny)
    fit = -0.5 * white.freedom * np.log(scatter) - 0.5 * np.linalg.slogdet(A)[1]
    evidence = fit + 1.5 * np.log(shrink) - white.lost + PRIOR[:, None]
    root = np.linalg.cholesky(np.linalg.inv(A)) * there[:, None, :, None]
    return _Cells(evidence, mean, root, scatter)


GROWTH = 1.2 ** np.arange(1, 26)
"""Lengths that are tried, in lengths of the record: steps of a fifth, to a hundred times."""
LONGEST = 8 * 3600.0
"""s of record, a working day, beyond which no length is proposed."""
MARGIN = 2.5
"""Standard errors of the forecast that must fit into what is allowed: 1.64 for the bound of 95 %, and the forecast
itself, which is not zero, is rarely more than one of its standard errors off."""
CELLS = 5
"""Likeliest cells, whose median length is stated."""


def needed(course: SettlingCourse, means: int, duration: float, allowed: float) -> float | None:
    """s more until the forecast over ``duration`` s is good to ``allowed``, m/s² or rad/s; None where none will do.

    Foreseen for as many ``means`` as now, each over more samples.
    """
    cells = np.argsort(course.weight)[-CELLS:]
    lengths = np.array([_enough(course, int(cell), means, duration, allowed) for cell in cells])
    order = np.argsort(lengths)
    share = np.cumsum(course.weight[cells][order])
    length = float(lengths[order][np.searchsorted(share, share[-1] / 2)])
    return length if np.isfinite(length) else None


def _enough(course: SettlingCourse, cell: int, means: int, duration: float, allowed: float) -> float:
    """s more under one cell; infinite where none will do."""
    for growth in GROWTH[GROWTH * course.span <= LONGEST]:
        if MARGIN * np.sqrt(_variance(course, cell, means, float(growth), duration)) <= allowed:
            return float((growth - 1) * course.span)
    return np.inf


def wander(course: SettlingCourse, duration: float) -> float:
    """One sigma of the walk over ``duration`` s, m/s² or rad/s."""
    variance = course.scatter / max(course.freedom - 2, 1) * course.walk * duration / course.span
    return float(np.sqrt(course.weight @ variance))


def _variance(course: SettlingCourse, cell: int, means: int, growth: float, duration: float) -> float:
    """Variance of the forecast, (m/s²)² or (rad/s)², by a record ``growth`` times as long."""
    span, tau, walk = growth * course.span, course.tau[cell], course.walk[cell] * growth**2
    sigma2 = course.scatter[cell] / course.freedom / growth
    x = (np.arange(means) + 0.5) / means
    L = np.linalg.cholesky(np.eye(means) + walk * np.minimum.outer(x, x))
    settles = -np.expm1(-np.outer(x, span / tau))
    white = solve_triangular(L, np.column_stack([np.ones(means), x, settles]), lower=True)
    h: Array = np.array([0.0, duration / span, *(np.exp(-span / tau) * -np.expm1(-duration / tau))])
    known = np.linalg.lstsq(white.T @ white + 1e-9 * np.eye(4), h, rcond=None)[0]
    return float(sigma2 * (h @ known + walk * duration / span))
