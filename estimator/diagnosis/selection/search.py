"""The search for causes: forward selection, every finding weighed again given the others, backward elimination.

A cause found later may change what was named earlier. Every finding is selected anew given the others until nothing
changes; drift that another effect explains, two causes of the stand in place of which a third was selected first, and
names that structure without a name explains better are taken back.
"""

from dataclasses import replace
from itertools import combinations

from estimator.diagnosis.selection.backward import (
    NAMELESS,
    backward_elimination,
    penalised_log_evidence,
    without_names_on_courses,
    without_needless_drift,
)
from estimator.diagnosis.selection.excess_noise import with_autocorrelation
from estimator.diagnosis.selection.forward import forward_selection, with_structures
from estimator.diagnosis.selection.ranking import joint_log_evidence, strongest
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.signatures.lasting import MANY
from estimator.diagnosis.signatures.scores import score

ROUNDS = 4
"""Times that every finding is selected anew: it bounds the search where two choices alternate."""


def search(start: SearchState) -> SearchState:
    """Causes, then the structure that they leave."""
    state = reselected(forward_selection(start))
    state = backward_elimination(best_common_pair(without_needless_drift(state)))
    state = without_names_on_courses(structures_or_names(with_structures(state)))
    return with_autocorrelation(backward_elimination(state))


def reselected(state: SearchState) -> SearchState:
    """Select every finding anew given the others, until nothing changes; drop what loses its significance."""
    rounds = 1 if state.sensor_count > MANY else ROUNDS
    for _ in range(rounds if state.detections else 0):
        groups = [f.best.group for f in state.detections]
        for old in state.detections:
            new = strongest(state, state.traces, without=old)
            detections = tuple(new if f is old else f for f in state.detections)
            state = replace(state, detections=tuple(f for f in detections if f is not None))
        state = forward_selection(state)
        if [f.best.group for f in state.detections] == groups:
            break
    return state


def best_common_pair(state: SearchState) -> SearchState:
    """Two causes of stand or fixture selected together: one after another, the first may stand in for both."""
    common = [f for f in state.detections if not f.best.sensors]
    if len(common) != 2:
        return state
    others = replace(state, detections=tuple(f for f in state.detections if f not in common))
    scored = score(state.residuals, state.traces, others.attributed())
    known = {f.best.group for f in common}
    best, log_evidence = state, joint_log_evidence(state)
    for first, second in combinations([s for s in scored if not s.sensors], 2):
        if {first.group, second.group} == known or first.group == second.group:
            continue
        pair = tuple(Detection(s, 0.0, ((s, s.log_evidence),)) for s in (first, second))
        rival = replace(others, detections=(*others.detections, *pair))
        if (value := joint_log_evidence(rival)) > log_evidence:
            best, log_evidence = rival, value
    return best if best is state else reselected(best)


def structures_or_names(state: SearchState) -> SearchState:
    """Withdraw names when structure without them explains the session better.

    Every further name, or structure, is a misfortune of its own. Tried for every name alone, for all names of one
    sensor together, for those of no sensor, and for all names; in a block of many sensors only where structure was
    left.
    """
    crowded = state.sensor_count > MANY
    for group in groups(state):
        if not all(f in state.detections for f in group) or (crowded and not overlaps(group, state.structures)):
            continue
        rival = without_names(state, group)
        if rival.structures and penalised_log_evidence(rival) > penalised_log_evidence(state) + NAMELESS:
            state = rival
    return state


def overlaps(group: tuple[Detection, ...], structures: tuple[Detection, ...]) -> bool:
    """Whether structure was left on a sensor of the group."""
    return bool({f.best.sensors for f in group} & {s.best.sensors for s in structures})


def without_names(state: SearchState, names: tuple[Detection, ...]) -> SearchState:
    """The search without some findings, and structure where they were; elsewhere as it was.

    What stand or fixture does is replaced by structure common to all sensors, not by a patchwork of single ones. A
    sensor's drift is not replaced by a change of no name, which is more of the same.
    """
    detections, touched = tuple(f for f in state.detections if f not in names), {f.best.sensors for f in names}
    drifts = any(f.best.cause.moves_parameters for f in names)
    patterns = tuple(t for t in state.patterns if not (drifts and t.cause.between))
    if len(touched) > 1:
        searched = with_structures(replace(state, detections=detections, structures=(), patterns=patterns))
        return replace(searched, patterns=state.patterns)
    (sensors,) = touched
    elsewhere = tuple(s for s in state.structures if s.best.sensors != sensors)
    there = tuple(t.at(sensors) for t in patterns if sensors or t.common)
    searched = with_structures(replace(state, detections=detections, structures=elsewhere, patterns=there))
    return replace(searched, patterns=state.patterns)


def groups(state: SearchState) -> list[tuple[Detection, ...]]:
    """The sets of findings that structure may replace, the largest first."""
    by_sensor: dict[tuple[int, ...], list[Detection]] = {}
    for f in state.detections:
        by_sensor.setdefault(f.best.sensors, []).append(f)
    sets = [state.detections, *map(tuple, by_sensor.values()), *((f,) for f in state.detections)]
    return list(dict.fromkeys(s for s in sets if s))
