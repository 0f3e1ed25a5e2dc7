"""Draws of a parameter's present level and future course, given its history and its type.

Every kind of change, its time, its size's scale and every strength of the walk is one hypothesis; its weight is prior
(`pooled`) times likelihood (`fits`). Given one of them all is normal: first the size a, then the level at the last
session. Hypotheses are drawn by the square root of their weight and carry the rest as a weight, so that rare ones, from
which most of the risk comes, are there.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.health.fits import CHANGES, PART_KINDS, PART_SIZES, WALKS, Fits, Readings, fits
from estimator.health.pooled import Prior
from estimator.health.shapes import Kind, Shapes, course, settled
from estimator.session import Array

FAINT = 1e-3
"""Share of a way of taking the readings that is left out: it changes a chance of 5 % by a hundredth of that at most."""
EACH = ("level", "rate", "aging", "constant", "walk", "kind", "slope")
"""The fields of `Draws` that hold one value, or vector, for each draw."""
DRAWS = 1600
"""A chance of 5 % is right to about half a percent, and the same history gives the same answer always."""


@dataclass(frozen=True, eq=False)
class Draws:
    """N equally valid presents and laws of motion; tolerances and years from the last session."""

    weight: Array
    """(N,) summing to one."""
    level: Array
    """(N, k) T."""
    rate: Array
    """(N, k) T a year, of a drift that goes on."""
    aging: Array
    """(N, k) T in the first year after the first session; of one that comes to an end in all."""
    constant: Array
    """(N,) τ of the aging, years."""
    walk: Array
    """(N,) T a root year."""
    kind: Array
    """(N,) `Kind` of the change in force."""
    age: float
    """Years from the first session to the last."""
    slope: Array
    """(N, k) T per °C, of one that follows the temperature; its level is that at the mean of its sessions."""

    @property
    def _ends(self) -> Array:
        """(N,) bool: whether aging comes to an end."""
        return np.asarray(self.kind == Kind.SETTLING)

    def aged(self, ahead: Array) -> Array:
        """(N, h) aging per unit of size from the last session on, at years ahead (h,)."""
        constant, since = self.constant[:, None], self.age + np.append(0.0, ahead)
        along = np.where(self._ends[:, None], settled(since, constant), course(since, constant))
        return np.asarray(along[:, 1:] - along[:, :1])

    def slowed(self) -> Array:
        """(N,) slope of that aging at the last session, a year."""
        constant = self.constant
        goes_on = 1 / ((self.age + constant) * np.log1p(1 / constant))
        return np.where(self._ends, np.exp(-self.age / constant) / constant, goes_on)

    def mean(self, values: Array) -> Array:
        """Weighted mean of (N, ...)."""
        return np.tensordot(self.weight, values, axes=1)


@dataclass(frozen=True, eq=False)
class Hypotheses:
    """G hypotheses with their weights."""

    weight: Array
    """(G,) summing to one."""
    log_evidence: float
    """Log of what they sum to by prior times likelihood; without unit."""
    walk: Array
    """(G,) place of the walk's strength."""
    part: Array
    """(G,) place of the part."""
    shape: Array
    """(G,) place of the shape; 0 without a change."""


def hypotheses_of(fitted: Fits, prior: Prior, given: Sequence[Kind] = ()) -> Hypotheses:
    """All hypotheses, by prior times likelihood; of the kinds that are given alone, where any are."""
    expected = np.log(np.maximum(prior.joint(fitted.span), 1e-300)) + fitted.log_likelihood.sum(axis=1)[:, None]
    logs, parts, places = [expected[:, :1]], [np.zeros(1, dtype=int)], [np.zeros(1, dtype=int)]
    for kind in CHANGES:
        shape, members = fitted.of_kind(kind), np.flatnonzero(kind == PART_KINDS)
        for p, ratios in zip(members, fitted.log_ratios(kind) + np.log(fitted.family.share[shape]), strict=True):
            logs.append(expected[:, p, None] + ratios)
            parts.append(np.full(len(shape), p))
            places.append(shape)
    log = np.concatenate(logs, axis=1)
    if given:
        log[:, ~np.isin(PART_KINDS[np.concatenate(parts)], given)] = -np.inf
    weight = np.exp(log - log.max())
    walk, column = np.indices(log.shape).reshape(2, -1)
    return Hypotheses(
        weight=weight.ravel() / weight.sum(),
        log_evidence=float(log.max() + np.log(weight.sum())),
        walk=walk,
        part=np.concatenate(parts)[column],
        shape=np.concatenate(places)[column],
    )


def draw(
    alternatives: Sequence[tuple[Readings, float]],
    family: Shapes,
    prior: Prior,
    rng: np.random.Generator,
    given: Sequence[Kind] = (),
) -> Draws:
    """Draws of what the readings leave open.

    Parameters
    ----------
    alternatives : ways of taking the same readings, with other columns that act, each with its log prior odds; at least
        one.
    family : shapes at the readings' dates.
    prior : of the type.
    given : kinds of change of which one is known to act; empty where nothing is known.
    """
    fitted = [fits(readings, family) for readings, _ in alternatives]
    every = [hypotheses_of(candidate, prior, given) for candidate in fitted]
    logs = np.array([all_of.log_evidence + log for all_of, (_, log) in zip(every, alternatives, strict=True)])
    share = np.exp(logs - np.logaddexp.reduce(logs))
    likely = [int(i) for i in np.flatnonzero(share > FAINT)]
    drawn = [_drawn(fitted[i], every[i], alternatives[i][0].value, rng) for i in likely]
    if len(drawn) == 1:
        return drawn[0]
    return Draws(
        weight=np.concatenate([sample.weight * share[i] for sample, i in zip(drawn, likely, strict=True)])
        / share[likely].sum(),
        age=drawn[0].age,
        **{name: np.concatenate([getattr(sample, name) for sample in drawn]) for name in EACH},
    )


def _drawn(fitted: Fits, all_of: Hypotheses, value: Array, rng: np.random.Generator) -> Draws:
    """Draws for readings (n, k) taken in one way."""
    family = fitted.family
    last = np.where(family.kind == Kind.WARMTH, 0.0, family.columns[-1])
    picked = _picked(all_of.weight, rng)
    weight = np.sqrt(all_of.weight[picked])
    q, part, shape = all_of.walk[picked], all_of.part[picked], all_of.shape[picked]
    size, level = _sizes_and_levels(fitted, value, last, (q, part, shape), rng)
    kind = PART_KINDS[part][:, None]
    return Draws(
        weight=weight / weight.sum(),
        level=level,
        rate=np.where((kind == Kind.LATE) | (kind == Kind.START), size, 0.0),
        aging=np.where((kind == Kind.AGING) | (kind == Kind.SETTLING), size, 0.0),
        constant=family.constant[shape],
        walk=WALKS[q],
        kind=PART_KINDS[part],
        age=fitted.span,
        slope=np.where(kind == Kind.WARMTH, size, 0.0),
    )


def _picked(weight: Array, rng: np.random.Generator) -> Array:
    """(N,) places, drawn systematically by the square root of their weight."""
    rough = np.cumsum(np.sqrt(weight))
    places = np.searchsorted(rough, rough[-1] * (np.arange(DRAWS) + rng.uniform()) / DRAWS)
    return np.minimum(places, len(weight) - 1)


def _sizes_and_levels(
    fitted: Fits, value: Array, last: Array, drawn: tuple[Array, Array, Array], rng: np.random.Generator
) -> tuple[Array, Array]:
    """(N, k) sizes and (N, k) levels of the hypotheses ``drawn``: walk, part and shape, each (N,)."""
    q, part, shape = drawn
    k = value.shape[1]
    known = np.einsum("qkn,nk->qk", fitted.gain, value)
    moved = last - fitted.gain @ fitted.family.columns
    has = (part > 0)[:, None]
    s2 = np.where(has, PART_SIZES[part][:, None] ** 2, 0.0)
    information, score = fitted.information[q, :, shape], fitted.score[q, :, shape]
    spread = s2 / (1 + s2 * information)
    size = spread * score + np.sqrt(spread) * rng.standard_normal((len(q), k))
    level = known[q] + size * moved[q, :, shape]
    return size, level + np.sqrt(fitted.variance[q]) * rng.standard_normal((len(q), k))
