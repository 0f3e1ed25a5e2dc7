"""A stand's own health, followed over the units that are measured on it.

A stand that turns, or a fixture that was re-seated, turns every block that is measured on it from then on, and no block
that is measured elsewhere. How blocks are seated anyway is estimated for every stand and unit (`seating`); what may
have happened is compared by χ² (`stand_events`, `stand_search`): nothing, a shift of a stand at any of its dates, one
that was taken back, several, or a unit that moved by itself. The most evident is taken into the model, the variances
are made anew, and so on until nothing is evident; what others explain better is then taken out again. The level 1 % is
shared by all dates and stands that were looked at (Bonferroni).

A shift is the stand's only when at least three units show it, when without any one of them it is more than chance
makes the largest of all that was looked at, and when four in five of the units that tell for themselves (their own
sigma at most a fifth of it) show it, one of any number left aside: a single unit that was dropped, or mounted badly, is
no fault of the stand. Values are in rad (turns) or relative (scales), covariances in rad² or relative².
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.health.seating import SeatedUnits, Seating, seated
from estimator.health.stand_events import (
    FEWEST_UNITS,
    LEVEL,
    EventTest,
    StandEvent,
    chi_squares,
    columns,
    event_test,
    of_units,
)
from estimator.health.stand_search import of_stands
from estimator.session import Array
from estimator.significance import critical_chi2

AGREEING = 0.8
"""Share of the units that must show the shift; one in five may differ, and one of any number."""
VOTING = 5.0
"""Sigmas of its own that a shift must have for a unit to have a vote: half of them is then far from either answer."""
SAME = 1e-6
"""Part of the information of events beside one another below which they are one."""
TRIED = 12
"""Stands, the most evident, whose best candidate is given a fit of its own."""
MOST_EVENTS = 24
"""Most events of a fleet that are distinguished; more are no single events."""
BUCKETS = 2.0
"""Units whose numbers of sessions are within this factor are worked on together."""


@dataclass(frozen=True, eq=False)
class StandMotion:
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
    """One shift of a stand."""

    since: float
    """Date of the first session that shows it, years."""
    until: float | None
    """Date of the first session that shows it no more; None while it lasts."""
    value: tuple[float, ...]
    """(k,) δ, rad or relative."""
    covariance: tuple[tuple[float, ...], ...]
    """(k, k) covariance of δ, rad² or relative²."""
    units: int
    """Number of units that have sessions with the shift and without it."""
    agreeing: int
    """Number of those units that show the shift in its direction."""
    chi2: float
    p_value: float
    """Chance of as evident a shift, all that was looked at included."""


@dataclass(frozen=True)
class StandState:
    """The state of one stand, by the units measured on it."""

    stand: str
    seating: float
    """τ, one sigma of how a block is seated, per component, rad or relative."""
    shifts: tuple[StandShift, ...]
    """Shifts in order of time."""
    suspected: StandShift | None
    """The most evident change of a stand without a shift; None where too few units inform it."""

    @property
    def has_shifted(self) -> bool:
        """Whether the stand is still displaced by a shift."""
        return any(shift.until is None for shift in self.shifts)

    @property
    def worst(self) -> StandShift | None:
        """The most evident shift, one that lasts before one that does not."""
        return max(self.shifts, key=lambda shift: (shift.until is None, shift.chi2), default=self.suspected)


def stand_states(motions: Sequence[StandMotion]) -> tuple[StandState, ...]:
    """Every stand, by name; motions of one quantity."""
    if not motions:
        return ()
    stands = sorted({motion.stand for motion in motions})
    groups, stand_of = _grouped(motions, stands)
    explained = _explained(groups, stand_of)
    return tuple(_state(i, name, explained) for i, name in enumerate(stands))


@dataclass(frozen=True)
class _Taken:
    """An event in the model, and how many of its class were looked at."""

    event: StandEvent
    looked: float


@dataclass(frozen=True, eq=False)
class _Explained:
    """The model with the events that were taken into it, and the candidates that were not."""

    seating: Seating
    taken: tuple[_Taken, ...]
    tried: tuple[tuple[_Taken, Seating], ...]
    """Candidates that were not evident, each the last event of a model of its own."""


def _explained(groups: Sequence[SeatedUnits], stand_of: Array) -> _Explained:
    """Events one after another, while one is evident; then without those that others explain."""
    taken = list[_Taken]()
    seating = seated(groups, columns(groups, ()), stand_of)
    while True:
        tried = [(candidate, _with(seating, groups, [*taken, candidate])) for candidate in _candidates(seating)]
        evident = [(candidate, new) for candidate, new in tried if _is_evident(new, len(taken), candidate)]
        if not evident or len(taken) == MOST_EVENTS:
            break
        candidate, _ = max(evident, key=lambda pair: event_test(pair[1], len(taken), pair[0].looked).evidence)
        taken.append(candidate)
        seating = seated(groups, columns(groups, [t.event for t in taken]), stand_of)
    return _Explained(*_pruned(seating, groups, taken), tuple(tried))


def _candidates(seating: Seating) -> list[_Taken]:
    """The candidates that deserve a fit of their own."""
    stands = sorted(of_stands(seating), key=lambda candidate: -candidate.gain)[:TRIED]
    unit = of_units(seating)
    return [_Taken(candidate.event, candidate.looked) for candidate in (*stands, *([] if unit is None else [unit]))]


def _with(seating: Seating, groups: Sequence[SeatedUnits], taken: Sequence[_Taken]) -> Seating:
    """The model with these events, its variances made anew."""
    return seated(groups, columns(groups, [entry.event for entry in taken]), seating.stand_of, seating.scatter)


def _pruned(seating: Seating, groups: Sequence[SeatedUnits], taken: list[_Taken]) -> tuple[Seating, tuple[_Taken, ...]]:
    """Drops events that are no longer evident, the least evident first."""
    while taken:
        failing = [i for i, entry in enumerate(taken) if not _is_evident(seating, i, entry)]
        if not failing:
            break
        least = min(failing, key=lambda i: event_test(seating, i, taken[i].looked).evidence)
        taken = [entry for i, entry in enumerate(taken) if i != least]
        seating = _with(seating, groups, taken)
    return seating, tuple(taken)


def _is_evident(seating: Seating, e: int, candidate: _Taken) -> bool:
    """Whether the e-th event of the model is beyond chance and, for a stand, confirmed by its units."""
    test = event_test(seating, e, candidate.looked)
    return test.exceeds(LEVEL) and (candidate.event.stand < 0 or _witnesses(seating, e).confirm(test))


@dataclass(frozen=True, eq=False)
class _Witnesses:
    """The evidence of each unit for one event, of the units that have any.

    Two events on some of the same sessions may differ by one terrible mounting, which then carries one of them: without
    a unit, those beside are what the other units make of them.
    """

    value: Array
    """(k,) δ, rad or relative."""
    information: Array
    """(u, k, k) 1/rad² or 1/relative²."""
    pull: Array
    """(u, k) 1/rad or 1/relative."""
    joint_information: Array
    """(u, m, m) information on it, first, and on the events that act on some of the same sessions."""
    pulled: Array
    """(u, m) pull of them all, none of them being in the model."""

    @property
    def agreeing(self) -> Array:
        """(u,) bool; at least half of δ, as the unit sees it."""
        return np.asarray(self.pull @ self.value > self._squared_size / 2)

    @property
    def _squared_size(self) -> Array:
        """(u,) δᵀJδ, the square of δ in the unit's own sigmas."""
        return np.asarray(np.einsum("a,uab,b->u", self.value, self.information, self.value))

    def confirm(self, test: EventTest) -> bool:
        """Whether the units are enough, agree, and do not all hang on a single one."""
        if self.agreeing.sum() < FEWEST_UNITS:
            return False
        votes = self.agreeing[self._squared_size > VOTING**2]
        by_chance = critical_chi2(min(LEVEL, 1 / test.looked), test.size, test.freedom)
        return bool(votes.sum() >= AGREEING * (len(votes) - 1)) and self._least_leave_one_out() > by_chance

    def _least_leave_one_out(self) -> float:
        """χ² without the unit that it rests on most, whatever the events beside it are then."""
        k = len(self.value)
        pull, whole = self.pulled.sum(axis=0) - self.pulled, self.joint_information.sum(axis=0) - self.joint_information
        shared = whole[:, :k, k:] @ np.linalg.pinv(whole[:, k:, k:], rcond=SAME, hermitian=True)
        free = whole[:, :k, :k] - shared @ whole[:, k:, :k]
        chi2, _ = chi_squares(pull[:, :k] - (shared @ pull[:, k:, None])[..., 0], free, whole[:, :k, :k])
        return float(chi2.min())


def _witnesses(seating: Seating, e: int) -> _Witnesses:
    """The units that have sessions with the e-th event and without."""
    k, rows = seating.value.shape[1], list[tuple[Array, ...]]()
    these = [e, *_overlapping(seating, e)]
    for part in seating.parts:
        column = part.column[:, :, e]
        some = (column.sum(axis=1) > 0) & (column.sum(axis=1) < part.units.there.sum(axis=1))
        acting = part.column[some][:, :, these]
        whole = np.einsum("uid,uiaeb->udaeb", acting, part.seen[some][:, :, :, these], optimize=True)
        rest = np.einsum("uid,uia->uda", acting, part.rest[some], optimize=True)
        pulled = rest + np.einsum("udaeb,eb->uda", whole, seating.value[these])
        information = whole[:, 0, :, 0]
        size = len(these) * k
        rows.append(
            (
                information,
                rest[:, 0] + information @ seating.value[e],
                whole.reshape(-1, size, size),
                pulled.reshape(-1, size),
            )
        )
    return _Witnesses(seating.value[e], *(np.concatenate(values) for values in zip(*rows, strict=True)))


def _overlapping(seating: Seating, e: int) -> list[int]:
    """The other events that act on some of the sessions that the e-th acts on."""
    shared = sum(np.einsum("ui,uif->f", part.column[:, :, e], part.column) for part in seating.parts)
    return [int(f) for f in np.flatnonzero(shared) if f != e]


def _state(number: int, name: str, explained: _Explained) -> StandState:
    """One stand."""
    shifts = [
        _shift(explained.seating, e, entry) for e, entry in enumerate(explained.taken) if entry.event.stand == number
    ]
    others = [_shift(new, len(new.value) - 1, entry) for entry, new in explained.tried if entry.event.stand == number]
    seating = float(np.sqrt(explained.seating.scatter.cell[explained.seating.stand_of == number].mean()))
    in_time = tuple(sorted(shifts, key=lambda shift: shift.since))
    return StandState(name, seating, in_time, None if shifts or not others else others[0])


def _shift(seating: Seating, e: int, candidate: _Taken) -> StandShift:
    test, units = event_test(seating, e, candidate.looked), _witnesses(seating, e)
    return StandShift(
        since=candidate.event.start,
        until=None if np.isinf(candidate.event.end) else candidate.event.end,
        value=tuple(map(float, seating.value[e])),
        covariance=tuple(tuple(map(float, row)) for row in seating.covariance[e, :, e]),
        units=len(units.pull),
        agreeing=int(units.agreeing.sum()),
        chi2=test.chi2,
        p_value=test.p_value,
    )


def _grouped(motions: Sequence[StandMotion], stands: Sequence[str]) -> tuple[list[SeatedUnits], Array]:
    """Units of like length together, and the stand of every pair of unit and stand."""
    by_unit: dict[str, list[StandMotion]] = {}
    for motion in sorted(motions, key=lambda m: m.time):
        by_unit.setdefault(motion.unit, []).append(motion)
    cells = {pair: i for i, pair in enumerate(sorted({(m.unit, m.stand) for m in motions}))}
    place = {stand: i for i, stand in enumerate(stands)}
    buckets: dict[int, list[tuple[int, list[StandMotion]]]] = {}
    for number, members in enumerate(by_unit.values()):
        buckets.setdefault(int(np.ceil(np.log(len(members)) / np.log(BUCKETS))), []).append((number, members))
    groups = [_units(members, cells, place) for _, members in sorted(buckets.items())]
    return groups, np.array([place[stand] for _, stand in cells])


def _units(
    members: Sequence[tuple[int, list[StandMotion]]], cells: Mapping[tuple[str, str], int], place: Mapping[str, int]
) -> SeatedUnits:
    """Arrays of units, filled up to the longest."""
    u, n, k = len(members), max(len(motions) for _, motions in members), len(members[0][1][0].value)
    value, noise, time = np.zeros((u, n, k)), np.tile(np.eye(k), (u, n, 1, 1)), np.zeros((u, n))
    stand, cell = np.full((u, n), -1), np.full((u, n), -1)
    for row, (_, motions) in enumerate(members):
        m = len(motions)
        value[row, :m] = [motion.value for motion in motions]
        noise[row, :m] = _alone(np.stack([motion.covariance for motion in motions]))
        time[row, :m] = [motion.time for motion in motions]
        stand[row, :m] = [place[motion.stand] for motion in motions]
        cell[row, :m] = [cells[motion.unit, motion.stand] for motion in motions]
    return SeatedUnits(value, noise, time, np.array([number for number, _ in members]), stand, cell)


def _alone(covariance: Array) -> Array:
    """(n, k, k) noise covariance of each session alone, from totals that hold the reference too.

    The reference is taken to be as uncertain as the best of the others, half of its total. Without another session
    there is nothing to compare, and any value will do.
    """
    traces = np.einsum("nkk->n", covariance)
    others = traces > 0
    if not others.any():
        return covariance + 1e-24 * np.eye(covariance.shape[1])
    best = int(np.argmin(np.where(others, traces, np.inf)))
    share = 1 - 0.5 * traces[best] / np.where(others, traces, traces[best])
    alone = np.where(others[:, None, None], covariance * share[:, None, None], covariance[best] / 2)
    return np.asarray(alone)
