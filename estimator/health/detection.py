"""Detects changes in a parameter by the odds of a change against none, corrected for all that was tried.

Null: noise of the stated covariance and the walk that half of the type's parameters do not exceed (`pooled`). Its rival
is one change of any kind, time and size (`odds`); the p-value is the chance of odds so high where nothing happens. The
kind is the likeliest, and so is its time, a priori anywhere alike; the size is that of the largest likelihood. Where
noise is estimated, readings shrink to what the best t statistic would be with known noise, with the degrees of freedom
of its own weights (Welch & Satterthwaite). A change that is found is taken into the base, and the next is looked for.

Temperature is a regressor where sessions span it, a line or a parabola (`warmth`). It is looked for first, and taken in
where its own p-value is small and it explains more than any change.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.special import ndtri, stdtr

from estimator.health.fits import WALKS, Fits, Readings, fits
from estimator.health.odds import Odds, mixture, odds
from estimator.health.shapes import DRIFTS, Kind, Shapes, shapes
from estimator.health.warmth import Warmth, warmth_of, with_temperature
from estimator.session import Array

MOST = 3
"""Changes that are looked for in one history; what changes more often walks."""
LEVEL = 0.01
"""Chance of a change being found in a unit that has none."""
FAINT = 1e-10
"""Part of the information of free readings below which a shape leaves no trace beside the base."""


@dataclass(frozen=True, eq=False)
class Change:
    """One change that was found, or the most likely one."""

    kind: Kind
    gap: int
    """Number of the session before which it came; 0 where it runs from the first."""
    constant: float
    """τ of an aging, years."""
    size: Array
    """(k,) T, or T a year for a drift; of an aging the change of its first year."""
    sigma: Array
    """(k,) one sigma of it."""
    p_value: float
    """p-value over all hypotheses, for this one parameter."""
    column: Array
    """(n,) shape of the change, per unit of size."""
    wanders: bool = False
    """Whether a walk is likelier than any single change."""


@dataclass(frozen=True, eq=False)
class Detected:
    """The changes, and the effect of temperature, that were found in one history."""

    p_value: float
    """Chance of evidence as strong for any change where there is none."""
    changes: tuple[Change, ...]
    """Found, the most evident first."""
    warmth: Warmth | None
    """Effect of temperature; None where the sessions do not span temperature."""
    readings: Readings
    """The readings, with temperature as a regressor where its effect was found."""

    @property
    def over(self) -> tuple[Change, ...]:
        """The jumps that are over: all but the change that is found last in time, which may be the beginning of a
        drift."""
        jumps = sorted((change for change in self.changes if change.kind is Kind.JUMP), key=lambda change: change.gap)
        return tuple(jumps if len(jumps) < len(self.changes) else jumps[:-1])

    def without_jumps(self) -> Readings:
        """The readings with the jumps that are over acting, of any size."""
        readings = self.readings
        for change in self.over:
            readings = _with(readings, change.column)
        return readings


@dataclass(frozen=True, eq=False)
class Warmed:
    """A history with temperature taken into account where it acts."""

    readings: Readings
    warmth: Warmth | None
    likely: Change | None
    """The most likely change besides; None where the sessions could not show any."""


def detect(readings: Readings, walk: float, dof: Array, temperature: Array, level: float) -> Detected:
    """The changes of one history whose chance is below a level.

    Parameters
    ----------
    readings : of the parameter; the base is the level alone.
    walk : T a root year, that counts as nothing.
    dof : (n,) degrees of freedom of each session's noise; infinite where it is known.
    temperature : (n,) °C of each session; NaN where it is not known.
    level : of this one parameter.
    """
    start = warmed(readings, walk, dof, temperature, level)
    if start.likely is None or start.likely.p_value >= level:
        return Detected(1.0 if start.likely is None else start.likely.p_value, (), start.warmth, start.readings)
    explained, changes = start.readings, list[Change]()
    remaining: Change | None = start.likely
    while remaining is not None and remaining.p_value < level and len(changes) < MOST:
        changes.append(remaining)
        explained = _with(explained, remaining.column)
        remaining = most_likely(explained, walk, dof)
    p = start.likely.p_value
    remains = remaining is not None and remaining.p_value < level
    if start.likely.wanders and (remains or _walks(start.readings, explained, walk)):
        return Detected(p, (_wandering(start.readings, p),), start.warmth, start.readings)
    return Detected(p, tuple(changes), start.warmth, start.readings)


def _walks(readings: Readings, explained: Readings, walk: float) -> bool:
    """Whether a walk explains the readings better than the changes that were taken into the base: by the largest
    likelihoods, each fitted number costing half the logarithm of the number of sessions (Schwarz 1978).
    """
    n, k = readings.value.shape
    price, changes = np.log(n) / 2, explained.base.shape[1] - readings.base.shape[1]
    wandered = _likelihood(readings, WALKS) - price
    return wandered > _likelihood(explained, np.array([walk])) - changes * (k + 1) * price


def _likelihood(readings: Readings, walks: Array) -> float:
    """Log of the largest, of all components, at the likeliest of ``walks`` (Q,) T a root year; without unit."""
    none = Shapes(np.zeros((len(readings.time), 0)), *(np.zeros(0, dtype=int) for _ in range(4)))
    fitted = fits(readings, none, walks)
    widths = np.log(np.diagonal(fitted.root, axis1=-2, axis2=-1)).sum(axis=-1)
    return -float((widths + (fitted.z**2).sum(axis=-1) / 2).sum(axis=1).min())


def warmed(readings: Readings, walk: float, dof: Array, temperature: Array, level: float) -> Warmed:
    """The parameters are those of `detect`."""
    likely = most_likely(readings, walk, dof)
    warmth = warmth_of(readings, temperature, None if likely is None else likely.column, level)
    if warmth is None or not warmth.is_found:
        return Warmed(readings, warmth, likely)
    readings = with_temperature(readings, temperature, warmth)
    return Warmed(readings, warmth, most_likely(readings, walk, dof))


def most_likely(readings: Readings, walk: float, dof: Array) -> Change | None:
    """The most likely change beyond the base; None where these sessions could not show any."""
    family, (n, k) = shapes(readings.time), readings.value.shape
    if n <= readings.base.shape[1]:
        return None
    null = fits(readings, family, np.array([walk]))
    information, score = null.information[0], null.score[0]
    raw = np.einsum("nh,nh->h", family.columns, family.columns) / (readings.sigma.min() ** 2)
    visible = (information > FAINT * np.maximum(raw, 1e-300)).all(axis=0)
    if not visible.any():
        return None
    information = np.where(visible, information, np.inf)
    squared = (score**2 / information).sum(axis=0)
    best = int(np.argmax(squared >= squared.max() * (1 - 1e-9)))
    shrunk = _shrunk(float(squared[best]), k, float(_freedom(null, readings, dof)[best]))
    chances = odds(mixture(null, readings.time, visible), null.z[0] * shrunk, readings.tails)
    kind = _kind(chances)
    likely = squared / 2 + np.log(np.maximum(family.share, 1e-300))
    likely = np.where(visible & _alike(family.kind, kind), likely, -np.inf)
    best = int(np.argmax(likely >= likely.max() - 1e-9))
    return Change(
        kind=Kind(int(family.kind[best])),
        gap=int(family.gap[best]),
        constant=float(family.constant[best]),
        size=score[:, best] / information[:, best],
        sigma=information[:, best] ** -0.5,
        p_value=chances.p_value,
        column=family.columns[:, best],
        wanders=kind is Kind.WALK,
    )


def _kind(likely: Odds) -> Kind:
    """The likeliest of a jump, a drift (of any sort) and a walk."""
    drifts = np.logaddexp.reduce([likely.of_kind[kind] for kind in DRIFTS])
    chances = {Kind.JUMP: likely.of_kind[Kind.JUMP], Kind.START: drifts, Kind.WALK: likely.of_kind[Kind.WALK]}
    return max(chances, key=lambda kind: chances[kind])


def _alike(kinds: Array, kind: Kind) -> Array:
    """(H,) bool: jumps, or drifts of any sort; all of a walk."""
    return np.asarray((kinds == Kind.JUMP) == (kind is Kind.JUMP)) | (kind is Kind.WALK)


def _wandering(readings: Readings, p_value: float) -> Change:
    """No shape, and no size but what is left of it at the end."""
    moved = readings.value[-1] - readings.value[0]
    sigma = np.hypot(readings.sigma[-1], readings.sigma[0])
    return Change(Kind.WALK, 0, 1.0, moved, sigma, p_value, np.zeros(len(readings.time)), wanders=True)


def _shrunk(squared: float, k: int, dof: float) -> float:
    """Factor on the readings that makes a statistic of k squares as rare as it would be with known noise."""
    if not np.isfinite(dof) or squared <= 0:
        return 1.0
    if k == 2:  # P(F > s/2) = (1 + s/dof)^(−dof/2), P(χ² > s) = exp(−s/2)
        return float(np.sqrt(dof * np.log1p(squared / dof) / squared))
    single = max(float(stdtr(dof, -np.sqrt(squared))), 1e-300)
    return float(-ndtri(single) / np.sqrt(squared))


def _freedom(null: Fits, readings: Readings, dof: Array) -> Array:
    """(H,) degrees of freedom of the noise in each statistic, of the fits at the one walk of the null."""
    if not np.isfinite(dof).any():
        return np.full(null.shapes.shape[-1], np.inf)
    weight = np.linalg.solve(null.root[0].swapaxes(1, 2), null.shapes[0])
    share = (weight * readings.sigma.T[..., None]) ** 2 / np.maximum(null.information[0], 1e-300)[:, None, :]
    spoilt = (share**2 / dof[:, None]).sum(axis=1).max(axis=0)
    return np.asarray(1 / np.maximum(spoilt, 1e-12))


def _with(readings: Readings, column: Array) -> Readings:
    """The readings with one more regressor; the level that is forecast is the one after the last session."""
    base = np.concatenate([readings.base, column[:, None]], axis=1)
    return replace(readings, base=base, now=np.append(readings.now, column[-1]))
