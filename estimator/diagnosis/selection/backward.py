"""Second thoughts: a cause found later may change what was named earlier.

Every finding is chosen anew given the others until nothing changes; drift that another effect explains, two causes of
the stand that a third one patched up, and names that structure without a name explains better are taken back.
"""

from dataclasses import replace
from itertools import combinations

import numpy as np

from estimator.diagnosis.selection.forward import DECISIVE, causes, loud, structures
from estimator.diagnosis.selection.search_state import LEVEL, Found, Search, beside, family_level, strongest, total
from estimator.diagnosis.signatures.autocorrelation import serial_structure
from estimator.diagnosis.signatures.lasting import MANY
from estimator.diagnosis.signatures.scores import rescored, score

NAMELESS = 1.5
"""ln evidence by which structure without a name must beat the named causes."""

BOTH = 3.0
"""ln evidence by which a cause together with more noise must beat one smooth course."""


def settle(state: Search) -> Search:
    """Choose every finding anew given the others, until nothing changes; drop what loses its significance."""
    rounds = 1 if len(state.baseline.unstated) > MANY else 4
    for _ in range(rounds if state.found else 0):
        groups = [f.best.group for f in state.found]
        for old in state.found:
            new = strongest(state, state.traces, without=old)
            kept = tuple(new if f is old else f for f in state.found)
            state = replace(state, found=tuple(f for f in kept if f is not None))
        state = causes(state)
        if [f.best.group for f in state.found] == groups:
            break
    return state


def without_needless_drift(state: Search) -> Search:
    """Take back a sensor's drift where another effect on that sensor, part of the history too, explains its move."""
    for drift in [f for f in state.found if f.best.cause.moves_parameters]:
        sensors = drift.best.shape.sensors
        others = [f for f in state.found if f is not drift and f.best.shape.sensors == sensors]
        for other in others:
            rest = replace(state, found=tuple(f for f in state.found if f is not drift))
            again = strongest(rest, rest.traces, without=other)
            if again is None or again.best.cause.moves_parameters:
                continue
            rival = replace(rest, found=tuple(again if f is other else f for f in rest.found))
            if total(rival) > total(state) - DECISIVE:
                state = rival
                break
    return state


def best_pair(state: Search) -> Search:
    """Two causes of stand or fixture chosen together: one after another, the first may patch up both."""
    common = [f for f in state.found if not f.best.shape.sensors]
    if len(common) != 2:
        return state
    others = replace(state, found=tuple(f for f in state.found if f not in common))
    scored = score(state.evidence, state.traces, others.taken())
    known = {f.best.group for f in common}
    best, weight = state, total(state)
    for first, second in combinations([s for s in scored if not s.shape.sensors], 2):
        if {first.group, second.group} == known or first.group == second.group:
            continue
        pair = tuple(Found(s, 0.0, ((s, s.evidence),)) for s in (first, second))
        rival = replace(others, found=(*others.found, *pair))
        if (value := total(rival)) > weight:
            best, weight = rival, value
    return best if best is state else settle(best)


def confirmed(state: Search) -> Search:
    """Every finding keeps its significance beside all others, or goes, the weakest first."""
    while state.found:
        again = [rescored(state.evidence, f.best, state.taken(without=f)) for f in state.found]
        level, weakest = max((family_level(s, state.families), k) for k, s in enumerate(again))
        if level < LEVEL:
            break
        state = replace(state, found=state.found[:weakest] + state.found[weakest + 1 :])
    return state


def judge_structures(state: Search) -> Search:
    """Withdraw names when structure without them explains the session better.

    Tried for every name alone, for all names of one sensor together, for those of no sensor, and for all names; in a
    block of many sensors only where structure was left.
    """
    crowded = len(state.baseline.unstated) > MANY
    for group in groups(state):
        if not all(f in state.found for f in group) or (crowded and not overlaps(group, state.structures)):
            continue
        kept = tuple(f for f in state.found if f not in group)
        rival = without_names(state, kept, {f.best.shape.sensors for f in group})
        if rival.structures and total(rival) > total(state) + NAMELESS:
            state = rival
    return state


def judge_courses(state: Search) -> Search:
    """Withdraw names on one sensor where its left-over without them is as well a smooth course of no name.

    Asked where they are several, or one that leaves more scatter than the sensor's noise: both are two faults at once.
    """
    m, noisy = len(state.baseline.unstated), loud(state)
    for i in range(m):
        names = tuple(f for f in state.found if f.best.shape.sensors == (i,))
        if not names or (len(names) == 1 and not noisy[i]):
            continue
        rest = replace(state, found=tuple(f for f in state.found if f not in names))
        known = not state.baseline.unstated[i]
        taken = rest.taken()
        uneven = serial_structure(rest.evidence, rest.left, taken, i, known=known)
        need = beside(rest, taken, names) + (-BOTH if noisy[i] else NAMELESS)
        if uneven is not None and uneven.evidence - np.log(m) > need:
            own = [e for e in state.excess if e.sensor == i]
            ratio, larger = float(np.prod([e.ratio for e in own])), float(sum(e.evidence for e in own))
            excess = tuple(e for e in rest.excess if e.sensor != i)
            others = tuple(s for s in rest.serial if s.sensor != i)
            state = replace(rest, excess=excess, serial=(*others, replace(uneven, ratio=ratio, excess=larger)))
    return state


def overlaps(group: tuple[Found, ...], structures: tuple[Found, ...]) -> bool:
    """Whether structure was left on a sensor of the group."""
    return bool({f.best.shape.sensors for f in group} & {s.best.shape.sensors for s in structures})


def without_names(state: Search, kept: tuple[Found, ...], touched: set[tuple[int, ...]]) -> Search:
    """The search with only the findings ``kept``, and structure where the others were; elsewhere as it was.

    What stand or fixture does is replaced by structure common to all sensors, not by a patchwork of single ones.
    """
    if len(touched) > 1:
        return structures(replace(state, found=kept, structures=()))
    own = next(iter(touched))
    elsewhere = tuple(s for s in state.structures if s.best.shape.sensors != own)
    there = tuple(t.at(own) for t in state.patterns if own or not t.shapes[0].sensors)
    return replace(
        structures(replace(state, found=kept, structures=elsewhere, patterns=there)), patterns=state.patterns
    )


def groups(state: Search) -> list[tuple[Found, ...]]:
    """The sets of findings that structure may replace, the largest first."""
    by_sensor: dict[tuple[int, ...], list[Found]] = {}
    for f in state.found:
        by_sensor.setdefault(f.best.shape.sensors, []).append(f)
    sets = [state.found, *map(tuple, by_sensor.values()), *((f,) for f in state.found)]
    return list(dict.fromkeys(s for s in sets if s))
