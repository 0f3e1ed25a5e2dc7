"""Forward selection of a group's findings, each weighed again given the others.

A name needs an e-value of 1/α for the group, given what was found before. A finding must hold without any one session,
and one on a type or a stand without any one unit: what one shows by itself is its own affair, and is left free there.
Where nameless structure on the sensors concerned is as sure as a name must be, the name is taken back: the cause does
not fit.
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.groups.evidence import ALPHA, SAME, SINCE, VARYING
from estimator.groups.layout import STAND, UNIT, GroupHypothesis, GroupLayout
from estimator.groups.pool import Place, Pool, PoolModel, columns_in, pooled
from estimator.groups.scores import batch
from estimator.groups.statistics import SessionStatistics
from estimator.groups.weighing import Scale, weigh
from estimator.least_squares import inverse
from estimator.session import Array
from estimator.significance import p_value

ENOUGH = float(-np.log(ALPHA))
"""ln e-value of a name."""

STILL = 0.01
"""p-value that the rest of the sessions must reach without the one, or the unit, that shows a finding most."""

MOST = 8
"""Findings of a group; what needs more is no sum of catalogue causes."""

FEW = 4
"""One session in so many may have an effect by itself that is no affair of the group; more have something else."""

ROUNDS = 40
"""Steps of the search: names taken, taken back, and sessions with an affair of their own."""

LARGEST = 0.3
"""Largest part of the applied vector that an effect may be, as within one session."""


@dataclass(frozen=True)
class Found:
    """One finding: a hypothesis in a form."""

    place: Place
    hypothesis: GroupHypothesis
    form: int
    since: int
    log_e: float
    """ln e-value of the group when it was taken, given those before."""


@dataclass(frozen=True, eq=False)
class GroupSelection:
    """The state of a group's selection."""

    layout: GroupLayout
    scale: Array
    """(n,) factor by which each session's variance exceeds the stated one."""
    found: tuple[Found, ...] = ()
    structures: tuple[tuple[GroupHypothesis, float], ...] = ()
    """Nameless structure, with its χ² in the pool."""
    misfits: tuple[tuple[GroupHypothesis, GroupHypothesis], ...] = ()
    """Names taken back, each with the structure that it left."""
    of_one_session: tuple[tuple[int, Place], ...] = ()
    """Effects that one session, or the sessions of one unit, have by themselves."""
    nameless: tuple[Place, ...] = ()
    """Structure that is in the fit."""
    barred: frozenset[tuple[str, ...]] = frozenset()
    aside: tuple[tuple[int, Place], ...] = ()
    """Effects left free in single sessions, since no cause describes what happens at their place."""
    doubted: frozenset[tuple[str, ...]] = frozenset()
    """Names that may as well be something outside the catalogue."""

    def model(self, without: Found | None = None) -> PoolModel:
        """The model of all findings, one left out."""
        model = PoolModel(absorbed=(*self.of_one_session, *self.aside))
        n = range(len(self.layout.parts))
        for place in self.nameless:
            model = model.with_shared(place)
        for f in self.found:
            if f is not without:
                varies = f.form == VARYING
                model = model.with_absorbed(n, f.place) if varies else model.with_shared(f.place, f.since)
        return model

    def weighed(self, without: Found | None = None) -> Scale:
        """All hypotheses given everything found, one finding left out."""
        return weigh(pooled(self.layout, self.model(without), self.scale), self.barred)


def select(
    layout: GroupLayout, barred: frozenset[tuple[str, ...]] = frozenset(), aside: tuple[tuple[int, Place], ...] = ()
) -> GroupSelection:
    """The findings of a group; ``barred`` hypotheses are not tried, those ``aside`` are left free in their session."""
    state = GroupSelection(layout, larger_than_stated(layout), barred=barred, aside=aside)
    for _ in range(ROUNDS):
        scale = state.weighed()
        step = plainly_nameless(state, scale)
        if step is None and len(state.found) < MOST:
            step = one_more(state, scale)
        if step is None:
            step = without_misfit(state, scale) or with_structure(state, scale)
        if step is None:
            break
        state = step
    return without_lesser(reselected(state))


def larger_than_stated(layout: GroupLayout) -> Array:
    """(n,) at least 1: by how much the sessions of each unit scatter more than they say, over all of them.

    Those that were corrected by themselves are asked apart. The largest effect of the unit is no scatter.
    """
    plain = pooled(layout)
    energy: dict[tuple[str, bool], Array] = {}
    for part in layout.parts:
        s = part.statistics
        sums = energy.setdefault(believed(s), np.zeros(2))
        sums += [s.energy.sum(), s.freedom.sum()]
    most = dict.fromkeys((unit for unit, _ in energy), 0.0)
    for w, moments in plain.moments.items():
        for h, t in zip(layout.hypotheses[w], batch(*moments.pooled)[0], strict=True):
            if h.subject in most:
                most[h.subject] = max(most[h.subject], float(t))
            elif h.level == STAND:
                most = {u: max(v, float(t) / len(most)) for u, v in most.items()}
    freedom = {u: sum(f for (v, _), (_, f) in energy.items() if v == u) for u in most}
    factor = {
        key: max(1.0, float((e - most[key[0]] * f / max(freedom[key[0]], 1.0)) / max(f, 1.0)))
        for key, (e, f) in energy.items()
    }
    return np.array([factor[believed(p.statistics)] for p in layout.parts])


def believed(s: SessionStatistics) -> tuple[str, bool]:
    """The unit of a session, and whether its noise was taken as stated."""
    return s.unit, bool(np.all(s.noise_factor == 1))


def one_more(state: GroupSelection, scale: Scale) -> GroupSelection | None:
    """The state with the strongest hypothesis, or with a session freed of it; None where nothing is enough."""
    if scale.log_e_value < ENOUGH:
        return None
    place, hypothesis, _ = next(scale.ranked())
    form = scale.form(place)
    since = int(scale.weighed[place[0]].since[place[1]]) if form == SINCE else 0
    alone = shown_by_one(scale.pool, place, form, since)
    often = sum(p == place for _, p in state.of_one_session) >= max(1, len(state.layout.parts) // FEW)
    if alone is not None and not often:
        return replace(state, of_one_session=(*state.of_one_session, *((session, place) for session in alone)))
    if alone is not None or not within_reason(scale.pool, place):
        return replace(state, barred=state.barred | {hypothesis.group})
    return replace(state, found=(*state.found, Found(place, hypothesis, form, since, scale.log_e_value)))


def plainly_nameless(state: GroupSelection, scale: Scale) -> GroupSelection | None:
    """The state with nameless structure that explains plainly more than any name; None where a name does as well."""
    best = next(iter(nameless_evidence(state, scale)), None)
    named = next(scale.ranked(), None)
    if best is None or (named is not None and best[0] < named[2] + ENOUGH):
        return None
    return with_structure(state, scale)


def shown_by_one(pool: Pool, place: Place, form: int, since: int) -> tuple[int, ...] | None:
    """The sessions of the one unit without which the others do not show a hypothesis any more; None where they do.

    An effect of a unit, and of a stand where only one unit was measured, must hold without any one session.
    """
    w, k = place
    m = pool.moments[w]
    U, F = m.evidence[:, k], m.F[:, k]
    level, units = pool.layout.hypotheses[w][k].level, [part.statistics.unit for part in pool.layout.parts]
    by_session = level == UNIT or (level == STAND and len(set(units)) == 1)
    names = range(len(units)) if by_session else units
    places = {name: n for n, name in enumerate(dict.fromkeys(names))}
    of_one = np.array([[places[name] == n for name in names] for n in range(len(places))])
    if form == VARYING:
        statistic, freedom = (x @ ~of_one.T for x in batch(U, F))
    else:
        counted = ~of_one & (np.arange(len(U)) >= since)
        statistic, freedom = batch(np.tensordot(counted, U, axes=1), np.tensordot(counted, F, axes=1))
    chance = np.array([1.0 if q <= 0 else p_value(float(t), int(q)) for t, q in zip(statistic, freedom, strict=True)])
    most = int(chance.argmax())
    return None if chance[most] < STILL else tuple(np.flatnonzero(of_one[most]).tolist())


def within_reason(pool: Pool, place: Place) -> bool:
    """Whether the amplitude that fits best is a small part of the applied vector."""
    w, k = place
    U, F = (x[k] for x in pool.moments[w].pooled)
    amplitude = np.abs(inverse(F) @ U)
    for part in pool.layout.parts:
        columns = columns_in(part, place)
        if columns is not None and columns[0] < len(part.statistics.reach):
            return bool(np.all(part.statistics.reach[columns] * amplitude < LARGEST))
    return True


def nameless_evidence(state: GroupSelection, scale: Scale) -> list[tuple[float, Place, GroupHypothesis]]:
    """ln evidence of nameless structure, its share among all of it included, strongest first."""
    found = []
    for w, table in state.layout.hypotheses.items():
        places = [k for k, h in enumerate(table) if h.nameless]
        values = scale.weighed[w].forms[SAME]
        found += [(float(values[k]), (w, k), table[k]) for k in places]
    return sorted(((v - np.log(len(found)), p, h) for v, p, h in found), key=lambda x: -x[0])


def without_misfit(state: GroupSelection, scale: Scale) -> GroupSelection | None:
    """The state without the weakest finding that leaves structure where it acts; None where all fit.

    In its place comes the structure, wherever it is, that is seen best without it.
    """
    structure = [(h, place) for v, place, h in nameless_evidence(state, scale) if v > ENOUGH]
    for f in sorted(state.found, key=lambda f: f.log_e):
        for h, place in structure:
            if concerns(f.hypothesis, h) and shown_by_one(scale.pool, place, SAME, 0) is None:
                less = taken_back(state, f, h)
                return with_structure(less, less.weighed()) or less
    return None


def taken_back(state: GroupSelection, found: Found, structure: GroupHypothesis) -> GroupSelection:
    """The state without a name that does not fit, which is not tried again."""
    return replace(
        state,
        found=tuple(x for x in state.found if x is not found),
        misfits=(*state.misfits, (found.hypothesis, structure)),
        barred=state.barred | {found.hypothesis.group},
    )


def without_lesser(state: GroupSelection) -> GroupSelection:
    """The state without names beside structure on the same sensor, or common to all, that explains more than they do:
    they are parts of what has no name."""
    for f in state.found:
        scale = state.weighed(without=f)
        statistic = float(scale.weighed[f.place[0]].statistic[f.place[1]])
        beside = [(h, value) for h, value in state.structures if concerns(f.hypothesis, h)]
        if beside and statistic < sum(value for _, value in beside):
            state = taken_back(state, f, beside[0][0])
    return state


def concerns(f: GroupHypothesis, structure: GroupHypothesis) -> bool:
    """Whether structure acts where a finding does; structure on another stand does not."""
    if not f.sensor or not structure.sensor:
        return f.sensor == structure.sensor and f.subject == structure.subject
    return f.sensor in (structure.sensor, "*") and (f.level != "unit" or f.subject == structure.subject)


def with_structure(state: GroupSelection, scale: Scale) -> GroupSelection | None:
    """The state with the strongest nameless structure in the fit; None where none is sure enough."""
    value, place, h = next(iter(nameless_evidence(state, scale)), (-np.inf, (0, 0), None))
    if h is None or value < ENOUGH or shown_by_one(scale.pool, place, SAME, 0) is not None:
        return None
    statistic = float(scale.weighed[place[0]].statistic[place[1]])
    return replace(state, nameless=(*state.nameless, place), structures=(*state.structures, (h, statistic)))


def reselected(state: GroupSelection) -> GroupSelection:
    """Every finding chosen again given the others; those that no longer hold are dropped."""
    for _ in range(3):
        before = [f.hypothesis.group for f in state.found]
        for old in state.found:
            rest = tuple(f for f in state.found if f is not old)
            scale = state.weighed(without=old)
            again = one_more(replace(state, found=rest), scale)
            new = again.found[-1] if again is not None and len(again.found) > len(rest) else None
            kept = (replace(new, log_e=scale.log_e_value),) if new is not None else ()
            others = iter(rest)
            state = replace(state, found=tuple(x for f in state.found for x in (kept if f is old else (next(others),))))
        if [f.hypothesis.group for f in state.found] == before:
            break
    return state
