"""Search for the dates at which a stand was turned, and turned back: its most evident change among pairs of dates.

    χ² = bᵀJ⁻¹b,    b = Σ Pz,  J = Σ P

over the stand's sessions between two dates, both freed of the events that are in the model already. Every pair of dates
of a stand with many sessions would be too many. Looked at are the pairs of dates spread evenly over its life and all
pairs of sessions near one another, since an excursion that few sessions saw is lost to who passes over half of them;
the ends of the best are then sought among all dates around them.

What looking costs: half of the level belongs to steps, which last and of which neighbours are nearly the same look
(`scan`), half to excursions, which end. An excursion of m sessions may begin at any date, and all lengths count alike
on a logarithmic scale: with n_s dates of stand s it costs as much as the largest of

    N(m) = m·Σ_s n_s·(1/3 + 1/4 + … + 1/n_s)

looks; fewer than three sessions are never three units. Those are Bonferroni's, with weights, whatever depends on what.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.health.scan import looks
from estimator.health.seating import Seating
from estimator.health.stand_events import FEWEST_UNITS, LEVEL, EventCandidate, StandEvent, chi_squares
from estimator.session import Array

MOST_DATES = 120
"""Most dates of one stand that are spread over its life: work grows with their square."""
ROW = 40
"""Dates in a row of which all pairs are looked at, every second half of them anew: an excursion of twenty sessions is
seen whole, and one of more leaves its middle in the spread dates of stands with a thousand sessions."""


def of_stands(seating: Seating) -> list[EventCandidate]:
    """Each stand's most evident changes, steps and excursions; only for stands that at least three units inform."""
    lives = [_life(seating, stand) for stand in range(len(seating.scatter.stand))]
    spread = [_tested_pairs(_from_each(seating, life, life.spread), seating) for life in lives]
    price = _Price(sum(pairs.steps for pairs in spread), sum(life.lengths for life in lives))
    best = (_best(seating, *pair, price) for pair in zip(lives, spread, strict=True))
    return [candidate for candidate in best if candidate is not None]


@dataclass(frozen=True, eq=False)
class _Life:
    """The sessions of one stand in order of time."""

    stand: int
    part: Array
    """(s,) number of the session's part of the fleet."""
    row: Array
    """(s,) row of its unit within the part."""
    place: Array
    """(s,) place among its unit's sessions."""
    time: Array
    """(s,) years."""
    dates: Array
    """(n,) years, each once."""

    @property
    def spread(self) -> Array:
        """(c,) dates spread evenly among those of the stand, years."""
        last = len(self.dates) - 1
        return self.dates[np.unique(np.linspace(0, last, MOST_DATES).round().astype(int))] if last >= 0 else self.dates

    @property
    def lengths(self) -> float:
        """Number of looks that excursions of a single session would cost."""
        n = len(self.dates)
        return n * float((1 / np.arange(FEWEST_UNITS, n + 1)).sum())

    def between(self, start: Array, end: Array) -> Array:
        """(p,) number of dates from (p,) years up to and without (p,) years."""
        return np.searchsorted(self.dates, end) - np.searchsorted(self.dates, start)

    def around(self, event: StandEvent) -> Array:
        """(c,) dates around both ends, as far as the spread ones passed over, years."""
        passed = -(-len(self.dates) // MOST_DATES)
        ends = np.searchsorted(self.dates, [event.start, event.end])
        near = np.unique(ends[:, None] + np.arange(-passed, passed + 1))
        return self.dates[near[(near >= 0) & (near < len(self.dates))]]


@dataclass(frozen=True)
class _Price:
    """The cost of looking, over all stands."""

    steps: float
    lengths: float
    """Cost of the excursions, in looks for those of one session."""

    def of(self, life: _Life, pairs: "_Pairs") -> Array:
        """(p,) looks that every pair costs; half of the level belongs to steps and half to excursions."""
        once = np.where(pairs.lasting, self.steps, life.between(pairs.start, pairs.end) * self.lengths)
        return np.maximum(2 * once, 1.0)


@dataclass(frozen=True, eq=False)
class _Sums:
    """Sums over a stand's sessions from each of c dates on; zero for the last date, which no session follows."""

    dates: Array
    """(c,) years, increasing; the last infinite where no session follows."""
    whole: Array
    """(c, k, c, k) J."""
    pull: Array
    """(c, k) b."""
    shared: Array
    """(c, k, e, k) J with the events of the model."""
    telling: Array
    """(c, c) units that have sessions between two dates, and others."""


@dataclass(frozen=True, eq=False)
class _Pairs:
    """Pairs of dates with enough units on either side."""

    start: Array
    """(p,) years."""
    end: Array
    """(p,) years; infinite where it lasts."""
    chi2: Array
    """(p,)"""
    steps: float
    """Looks that those are worth that last."""

    @property
    def lasting(self) -> Array:
        """(p,) bool."""
        return np.isinf(self.end)


def _life(seating: Seating, stand: int) -> _Life:
    """The sessions on a stand."""
    rows = []
    for number, part in enumerate(seating.parts):
        row, place = np.nonzero(part.units.stand == stand)
        rows.append(np.stack([np.full(len(row), number), row, place, part.units.time[row, place]]))
    every = np.concatenate(rows, axis=1)
    every = every[:, np.argsort(every[3], kind="stable")]
    part, row, place = every[:3].astype(int)
    return _Life(stand, part, row, place, every[3], np.unique(every[3]))


def _best(seating: Seating, life: _Life, spread: _Pairs, price: _Price) -> EventCandidate | None:
    """The pair with the largest gain."""
    rows = (
        [_tested_pairs(sums, seating) for sums in _in_rows(seating, life)] if len(life.spread) < len(life.dates) else []
    )
    best = _largest(life, [spread, *rows], price)
    if best is None or not rows or np.isinf(best.event.end):
        return best
    return _largest(life, [_tested_pairs(_from_each(seating, life, life.around(best.event)), seating)], price, best)


def _largest(
    life: _Life, looked: Sequence[_Pairs], price: _Price, than: EventCandidate | None = None
) -> EventCandidate | None:
    """The pair with the largest gain of all that were looked at; ``than`` where none gains more."""
    best = than
    for pairs in looked:
        if not len(pairs.chi2):
            continue
        prices = price.of(life, pairs)
        i = int(np.argmax(pairs.chi2 / 2 - np.log(prices)))
        event = StandEvent(life.stand, -1, float(pairs.start[i]), float(pairs.end[i]))
        candidate = EventCandidate(event, float(pairs.chi2[i]), float(prices[i]))
        best = candidate if best is None or candidate.gain > best.gain else best
    return best


def _tested_pairs(sums: _Sums, seating: Seating) -> _Pairs:
    """χ² of every pair of dates."""
    free = sums.whole - np.einsum("caex,exfy,dbfy->cadb", sums.shared, seating.covariance, sums.shared, optimize=True)
    i, j = np.triu_indices(len(sums.dates), 1)
    chi2, seen = chi_squares(sums.pull[i] - sums.pull[j], _between(free, i, j), _between(sums.whole, i, j))
    valid = seen & (sums.telling[i, j] >= FEWEST_UNITS)
    i, j, chi2 = i[valid], j[valid], chi2[valid]
    permanent = i[np.isinf(sums.dates[j])]
    steps = looks(_alike(free, permanent), sums.pull.shape[1], LEVEL / 2) if len(permanent) else 0.0
    return _Pairs(sums.dates[i], sums.dates[j], chi2, steps)


def _from_each(seating: Seating, life: _Life, dates: Array) -> _Sums:
    """Sums from each of the given dates on, (c,) years."""
    dates = np.append(dates, np.inf)
    c, k, e = len(dates), *seating.value.T.shape
    whole, pull, shared = np.zeros((c, k, c, k)), np.zeros((c, k)), np.zeros((c, k, e, k))
    telling = np.zeros((c, c), dtype=int)
    for part in seating.parts:
        some = (part.units.stand == life.stand).any(axis=1)
        if not some.any():
            continue
        where, time = part.units.stand[some] == life.stand, part.units.time[some]
        d = (where[:, :, None] & (time[:, :, None] >= dates)).astype(float)
        moved = np.einsum("uiajb,ujd->uiadb", part.precision[some], d, optimize=True)
        whole += np.einsum("uic,uiadb->cadb", d, moved, optimize=True)
        pull += np.einsum("uic,uia->ca", d, part.rest[some], optimize=True)
        shared += np.einsum("uic,uiaeb->caeb", d, part.seen[some], optimize=True)
        telling += _telling(d.sum(axis=1), part.units.there[some].sum(axis=1))
    return _Sums(dates, whole, pull, shared, telling)


def _in_rows(seating: Seating, life: _Life) -> Iterator[_Sums]:
    """Sums from every date in overlapping rows of dates; none of these pairs lasts."""
    starts = range(0, max(len(life.dates) - ROW // 2, 1), ROW // 2)
    return (_row(seating, life, life.dates[start : start + ROW]) for start in starts)


def _row(seating: Seating, life: _Life, dates: Array) -> _Sums:
    """Sums between the dates (c,), years; the session at the last counts for nothing."""
    first, last = np.searchsorted(life.time, dates[[0, -1]])
    inside, (k, e) = slice(first, last), seating.value.T.shape
    w = last - first
    whole, pull, shared = np.zeros((w, k, w, k)), np.zeros((w, k)), np.zeros((w, k, e, k))
    unit, sessions = np.zeros(w, dtype=int), np.zeros(w, dtype=int)
    for number, part in enumerate(seating.parts):
        at = np.flatnonzero(life.part[inside] == number)
        row, place = life.row[inside][at], life.place[inside][at]
        same = (row[:, None] == row)[..., None, None]
        whole[at[:, None], :, at] = part.precision[row[:, None], place[:, None], :, place] * same
        pull[at], shared[at] = part.rest[row, place], part.seen[row, place]
        unit[at], sessions[at] = part.units.unit[row], part.units.there[row].sum(axis=1)
    begins = np.searchsorted(life.time[inside], dates)
    units, which = np.unique(unit, return_index=True)
    after = _from_on((unit[:, None] == units).astype(float))[begins]
    return _Sums(
        dates,
        _from_on(_from_on(whole)[begins].swapaxes(0, 2))[begins].swapaxes(0, 2),
        _from_on(pull)[begins],
        _from_on(shared)[begins],
        _telling(after.T, sessions[which]),
    )


def _from_on(values: Array) -> Array:
    """(w + 1, ...) sums from each of (w, ...) to the last, and of none."""
    return np.concatenate([np.flip(np.cumsum(np.flip(values, 0), axis=0), 0), np.zeros((1, *values.shape[1:]))])


def _alike(free: Array, steps: Array) -> Array:
    """(s − 1,) least correlation between the scores of a step (s,) and the next, from the information (c, k, c, k)."""
    values, vectors = eigh(free[steps, :, steps])
    root = (vectors / np.sqrt(values)[:, None, :]) @ vectors.swapaxes(1, 2)
    shared = root[:-1] @ free[steps[:-1], :, steps[1:]] @ root[1:]
    return np.asarray(np.linalg.svd(shared, compute_uv=False).min(axis=1, initial=1.0))


def _telling(after: Array, sessions: Array) -> Array:
    """(c, c) number of units with sessions between two dates and others besides; ``after`` (u, c) from each date on."""
    between = after[:, :, None] - after[:, None, :]
    return np.asarray(((between > 0) & (between < sessions[:, None, None])).sum(axis=0))


def _between(whole: Array, i: Array, j: Array) -> Array:
    """(p, k, k) information on a change between two dates, from that of all pairs (c, k, c, k)."""
    return np.asarray(whole[i, :, i] + whole[j, :, j] - whole[i, :, j] - whole[j, :, i])
