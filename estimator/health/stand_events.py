"""Events that may have befallen a stand or a unit, and when: each hypothesis is weighed by χ².

Nothing; a stand turned at a date; a stand turned and was turned back (a fixture seated badly for a month); a unit moved
by itself at a date, whatever it was measured on. An event adds a column D to the model of `seating`, and its δ lowers
the restricted χ² by

    χ² = bᵀJ⁻¹b,    b = DᵀPz,  J = DᵀPD, both freed of the events that are in the model already

The candidate with the largest χ²/2 − ln N of its class, N how many of it were looked at (of stands: `stand_search`), is
fitted with the variances made anew, because an event that is not in the model passes for scatter. Its variance
V = tr J⁻¹ holds parts that were estimated: v_c by the variance θ_c, known to d_c degrees of freedom (twice its
information), hence V to V²/Σ v_c²/d_c of them (Satterthwaite). χ²/k is Fisher's F of k and so many; the log likelihood
that decides between hypotheses is Student's, (ν + k)/2·ln(1 + χ²/ν) − ln N, which never underflows. Units as in
`seating`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.health.seating import STAND_PRIOR, SeatedUnits, Seating, Weighted, freedoms
from estimator.session import Array
from estimator.significance import critical_chi2, family_wise, p_value

LEVEL = 0.01
"""Chance that any stand of a fleet is flagged although none moved."""
FEWEST_UNITS = 3
"""Two that differ cannot say which of them changed."""
SEEN = 1e-3
"""Least part of its information that an event keeps beside those in the model; with less it is one of them."""
LEAST = 1e-9
"""Least information of an event as a part of the largest beside it: what rounding leaves of none is not looked at."""


@dataclass(frozen=True)
class StandEvent:
    """A change of a stand, or of a unit, between two times."""

    stand: int
    """−1: of a unit."""
    unit: int
    """−1: of a stand."""
    start: float
    """years; the first session that shows it."""
    end: float
    """years; the first session that shows it no more; infinite while it lasts."""

    def column(self, g: SeatedUnits) -> Array:
        """(u, n) 1 where it acts."""
        where = g.stand == self.stand if self.stand >= 0 else (g.unit == self.unit)[:, None] & g.there
        return (where & (g.time >= self.start) & (g.time < self.end)).astype(float)


@dataclass(frozen=True)
class EventCandidate:
    """An event, and how many of its class were looked at, or what so many are worth for one of its length."""

    event: StandEvent
    chi2: float
    looked: float

    @property
    def gain(self) -> float:
        """χ²/2 − ln N."""
        return self.chi2 / 2 - float(np.log(self.looked))


@dataclass(frozen=True)
class EventTest:
    """An event in the model."""

    chi2: float
    freedom: float
    """Degrees of freedom that its variance is known to."""
    size: int
    """k."""
    looked: float

    def exceeds(self, level: float) -> bool:
        """Whether chance alone reaches as large a χ² with less than this probability, all that was looked at
        included.
        """
        return self.chi2 > critical_chi2(level / self.looked, self.size, self.freedom)

    @property
    def p_value(self) -> float:
        """Chance of as large a χ², all that was looked at included."""
        return family_wise(float(p_value(self.chi2, self.size, self.freedom)), self.looked)

    @property
    def evidence(self) -> float:
        """Gain of the log likelihood, less what looking costs."""
        gain = (self.freedom + self.size) / 2 * np.log1p(self.chi2 / self.freedom)
        return float(gain - np.log(self.looked))


def columns(groups: Sequence[SeatedUnits], events: Sequence[StandEvent]) -> list[Array]:
    """D (u, n, e) of every group."""
    nothing = [np.zeros((*g.stand.shape, 0)) for g in groups]
    return [np.stack([e.column(g) for e in events], axis=2) if events else none
            for g, none in zip(groups, nothing, strict=True)]  # fmt: skip


def chi_squares(pull: Array, free: Array, whole: Array) -> tuple[Array, Array]:
    """(p,) χ² and (p,) bool whether it shows beside the model; pull (p, k), both informations (p, k, k)."""
    traces = np.einsum("pkk->p", free), np.einsum("pkk->p", whole)
    seen = traces[0] > SEEN * np.maximum(traces[1], LEAST * traces[1].max(initial=1e-300))
    identity = np.eye(pull.shape[1])
    safe = np.where(seen[:, None, None], free + 1e-9 * traces[1][:, None, None] * identity, identity)
    return np.where(seen, np.einsum("pk,pk->p", pull, np.linalg.solve(safe, pull[..., None])[..., 0]), 0.0), seen


def of_units(seating: Seating) -> EventCandidate | None:
    """The most evident move of a single unit."""
    best: tuple[float, StandEvent] | None = None
    looked = 0
    for part in seating.parts:
        back = np.flip(np.flip(part.precision, (1, 3)).cumsum(axis=1).cumsum(axis=3), (1, 3))
        whole = np.einsum("uiaib->uiab", back)
        pull = np.flip(np.flip(part.rest, 1).cumsum(axis=1), 1)
        valid = part.units.there & (np.arange(part.units.there.shape[1]) > 0)
        u, i = np.nonzero(valid)
        looked += len(u)
        chi2, _ = chi_squares(pull[u, i], whole[u, i], whole[u, i])
        if len(u) and (best is None or chi2.max() > best[0]):
            at = int(chi2.argmax())
            unit, time = int(part.units.unit[u[at]]), float(part.units.time[u[at], i[at]])
            best = float(chi2[at]), StandEvent(-1, unit, time, np.inf)
    return None if best is None else EventCandidate(best[1], best[0], looked)


def event_test(seating: Seating, e: int, looked: float) -> EventTest:
    """The e-th event of the model."""
    value, covariance = seating.value[e], seating.covariance[e, :, e]
    chi2 = float(value @ np.linalg.pinv(covariance, hermitian=True) @ value)
    return EventTest(chi2, _freedom(seating, e), len(value), looked)


def _freedom(seating: Seating, e: int) -> float:
    """Satterthwaite's degrees of freedom of the e-th event's variance."""
    cells, stands = len(seating.stand_of), len(seating.scatter.fixed)
    by_cell, fixed = np.zeros(cells), np.zeros((2, stands))
    for part in seating.parts:
        there, same = part.units.there, part.units.same
        weight = np.einsum("uiaeb,ebc->uiac", part.seen, seating.covariance[:, :, e], optimize=True)
        gathered = np.einsum("uij,ujac->uiac", same, weight)
        parts = (weight**2).sum(axis=(2, 3)), (weight * gathered).sum(axis=(2, 3))
        by_cell += np.bincount(part.units.cell[there], parts[0][there], cells)
        fixed[0] += np.bincount(part.units.stand[there], parts[1][there], stands)
        fixed[1] += np.bincount(part.units.stand[there], _known(part)[there], stands)
    doubt = _of_cells(seating, seating.scatter.cell * by_cell) + _of_fixed(seating, fixed)
    return float(np.trace(seating.covariance[e, :, e]) ** 2 / max(doubt, 1e-300))


def _of_cells(seating: Seating, v: Array) -> float:
    """Half the variance that the τ² give a variance: of each unit by itself, and of what is typical of its stand, which
    all of its units share; v (c,) what each adds."""
    nu, stand = seating.scatter.alike, seating.stand_of
    d = freedoms(seating)
    typical = np.bincount(stand, d * nu / (d + nu)) + STAND_PRIOR
    shared = np.bincount(stand, v * nu / (d + nu))
    return float((v**2 / (d + nu)).sum() + (shared**2 / typical).sum())


def _of_fixed(seating: Seating, sums: Array) -> float:
    """Half the variance that the ω² give a variance; sums (2, s) what each adds and is known by, per variance and per
    variance squared.
    """
    theta = seating.scatter.fixed
    return float(((theta * sums[0]) ** 2 / (theta**2 * sums[1] + STAND_PRIOR)).sum())


def _known(part: Weighted) -> Array:
    """(u, n) the information on ω² of each unit and stand, shared out among its sessions, one over variance squared."""
    same = part.units.same
    gathered = np.einsum("uij,uiajb,uli->ulab", same, part.precision, same, optimize=True)
    return np.asarray((gathered**2).sum(axis=(2, 3)) / np.maximum(same.sum(axis=2), 1))
