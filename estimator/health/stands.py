"""A stand's own health, followed over the units that are measured on it.

A stand that turns, or a fixture that was re-seated, turns every block that is measured on it from then on, and no block
that is measured elsewhere. For a stand and a date the contrast of a unit is

    c_u = mean of its common motions on this stand from that date on − mean of all its others,

the reference session itself counting as a motion of zero; in the difference the unit's own reference drops out. Over
the units c_u = δ + a_u + e_u: δ the stand's shift, e_u with the covariance of the sessions, a_u with the scatter τ²
that units have anyway (how a block is seated, what its sensors do on their own), the typical one over all stands and
dates. δ is the generalised least squares mean. What the units scatter about it, their χ² per degree of freedom, widens
its covariance V where it is more than one (Birge's ratio): how blocks are seated counts for more where a unit has few
sessions. δᵀV⁻¹δ/k is then Fisher's F with k and k(u − 1) degrees of freedom when the stand has not moved, u the units.
The level 1 % is shared by all dates and stands that were looked at (Bonferroni), and a stand is flagged only
when at least three units show the shift and four in five of them in its direction: a single unit that was dropped is no
fault of the stand. Values are in rad (turns) or relative (scales), covariances in rad² or relative².
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import stats

from estimator.health.population import spread
from estimator.session import Array

LEVEL = 0.01
"""Chance that any stand of a fleet is flagged although none moved."""
FEWEST_UNITS = 3
"""Two that differ cannot say which of them changed."""
MOST_DATES = 48
"""Of one stand that are looked at, evenly among its sessions: work and Bonferroni's price grow with them."""
AGREEING = 0.8
"""Share of the units that must show the shift; one in five may differ."""


@dataclass(frozen=True, eq=False)
class Motion:
    """The common motion of one session of one unit."""

    stand: str
    unit: str
    time: float
    """Years, from any start."""
    value: Array
    """(k,) rotation vector, rad (k = 3), or relative change of all scales (k = 1); zero at a unit's reference."""
    covariance: Array
    """(k, k) total, rad² or relative²; of a reference session zero."""


@dataclass(frozen=True)
class StandShift:
    """What the units say of one stand."""

    stand: str
    units: int
    """That were measured on it from the date on and elsewhere or before too."""
    agreeing: int
    """Of them, that show the shift's direction."""
    since: float | None
    """Date of the first session that shows the shift, years; None where too few units tell."""
    value: tuple[float, ...]
    """(k,) δ, rad or relative; empty where too few units tell."""
    covariance: tuple[tuple[float, ...], ...]
    """(k, k) of δ, rad² or relative²."""
    p_value: float | None
    """Corrected for the dates and stands that were looked at."""
    has_shifted: bool


def stand_shifts(motions: Sequence[Motion]) -> tuple[StandShift, ...]:
    """Every stand's most evident shift, by name; motions of one quantity.

    The stand that has shifted most evidently is named first, and what was measured on it since is left out when the
    others are looked at: their units were measured there too.
    """
    known: dict[str, StandShift] = {}
    left = list(motions)
    while True:
        found = [shift for shift in _looked_at(left) if shift.stand not in known]
        shifted = [shift for shift in found if shift.has_shifted]
        if not shifted:
            every = known | {shift.stand: shift for shift in found}
            return tuple(every[stand] for stand in sorted(every))
        worst = min(shifted, key=lambda shift: (shift.p_value or 0.0, -float(np.linalg.norm(shift.value))))
        known[worst.stand] = worst
        left = [m for m in left if not (m.stand == worst.stand and m.time >= (worst.since or 0.0))]


def _looked_at(motions: Sequence[Motion]) -> list[StandShift]:
    """Every stand by itself."""
    stands = sorted({motion.stand for motion in motions})
    contrasts = {stand: _contrasts(stand, motions) for stand in stands}
    every = [contrast for found in contrasts.values() for contrast in found]
    scatter = float(np.median([_scatter(contrast) for contrast in every])) if every else 0.0
    cases = {stand: [_case(contrast, scatter) for contrast in found] for stand, found in contrasts.items()}
    return [_worst(stand, cases[stand], max(len(every), 1)) for stand in stands]


@dataclass(frozen=True, eq=False)
class _Contrast:
    """One stand and one date, unit by unit."""

    since: float
    value: Array
    """(u, k) rad or relative."""
    covariance: Array
    """(u, k, k) of the sessions, rad² or relative²."""


def _scatter(contrast: _Contrast) -> float:
    """τ² per component: what the sessions' own uncertainties leave of the spread between units."""
    own = np.sqrt(np.diagonal(contrast.covariance, axis1=1, axis2=2))
    return float(np.mean([spread(v, s)[1] ** 2 for v, s in zip(contrast.value.T, own.T, strict=True)]))


@dataclass(frozen=True, eq=False)
class _Case:
    """One stand and one date, over all units."""

    since: float
    units: int
    agreeing: int
    value: Array
    """(k,) δ, rad or relative."""
    covariance: Array
    """(k, k) of δ, rad² or relative²."""
    p: float
    """Of δ by chance, before the correction for all stands and dates."""


@dataclass(frozen=True, eq=False)
class _Table:
    """Motions as arrays: n sessions of units numbered from 0."""

    unit: Array
    """(n,) number of each unit."""
    time: Array
    """(n,) years."""
    there: Array
    """(n,) bool; whether on the stand that is looked at."""
    value: Array
    """(n, k) rad or relative."""
    covariance: Array
    """(n, k, k) rad² or relative²."""


def _contrasts(stand: str, motions: Sequence[Motion]) -> list[_Contrast]:
    """For every date on the stand that three units tell of; of very many dates as many as are worth looking at."""
    _, unit = np.unique([m.unit for m in motions], return_inverse=True)
    table = _Table(
        unit=unit,
        time=np.array([m.time for m in motions]),
        there=np.array([m.stand == stand for m in motions]),
        value=np.stack([m.value for m in motions]),
        covariance=np.stack([m.covariance for m in motions]),
    )
    dates = np.unique(table.time[table.there])
    chosen = dates[np.unique(np.linspace(0, len(dates) - 1, MOST_DATES).round().astype(int))]
    found = (_contrast(float(date), table) for date in chosen)
    return [contrast for contrast in found if len(contrast.value) >= FEWEST_UNITS]


def _contrast(since: float, table: _Table) -> _Contrast:
    """Of every unit that was measured there since the date, and also elsewhere or before."""
    after = table.there & (table.time >= since)
    (late, p, some), (early, q, others) = (_means(table, part) for part in (after, ~after))
    both = (some > 0) & (others > 0)
    return _Contrast(since, (late - early)[both], (p + q)[both])


def _case(contrast: _Contrast, scatter: float) -> _Case:
    """The units' mean contrast; ``scatter`` is τ², rad² or relative²."""
    k = contrast.value.shape[1]
    weight = np.linalg.inv(contrast.covariance + (scatter + 1e-24) * np.eye(k))
    covariance = np.linalg.inv(weight.sum(axis=0))
    value = covariance @ np.einsum("uij,uj->i", weight, contrast.value)
    rest, freedom = contrast.value - value, k * (len(contrast.value) - 1)
    dispersion = max(float(np.einsum("ui,uij,uj->", rest, weight, rest)) / freedom, 1.0)
    covariance = dispersion * covariance
    ratio = float(value @ np.linalg.solve(covariance, value)) / k
    agreeing = int((contrast.value @ value > 0.5 * float(value @ value)).sum())
    return _Case(contrast.since, len(contrast.value), agreeing, value, covariance, float(stats.f.sf(ratio, k, freedom)))


def _means(table: _Table, part: Array) -> tuple[Array, Array, Array]:
    """Mean (units, k) of every unit over a part of the sessions, rad or relative, its covariance (units, k, k), and how
    many there are (units,); ``part`` (n,) bool."""
    units, k = int(table.unit.max()) + 1, table.value.shape[1]
    count = np.bincount(table.unit[part], minlength=units)
    value, covariance = np.zeros((units, k)), np.zeros((units, k, k))
    np.add.at(value, table.unit[part], table.value[part])
    np.add.at(covariance, table.unit[part], table.covariance[part])
    n = np.maximum(count, 1)[:, None]
    return value / n, covariance / n[..., None] ** 2, count


def _worst(stand: str, cases: Sequence[_Case], looked: int) -> StandShift:
    """A stand's most evident date, among all ``looked`` at."""
    if not cases:
        return StandShift(stand, 0, 0, None, (), (), None, False)
    case = min(cases, key=lambda c: (c.p, c.since))
    p = min(case.p * looked, 1.0)
    shifted = p < LEVEL and case.agreeing >= max(FEWEST_UNITS, AGREEING * case.units)
    return StandShift(
        stand=stand,
        units=case.units,
        agreeing=case.agreeing,
        since=case.since,
        value=tuple(map(float, case.value)),
        covariance=tuple(tuple(map(float, row)) for row in case.covariance),
        p_value=p,
        has_shifted=shifted,
    )
