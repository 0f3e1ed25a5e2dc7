"""Forward selection: causes added one after another until none is significant any more.

Before a scatter larger than stated is called excess noise, it is looked at without belief in the stated noise: no
signature and no pattern may stand out of it, and it may not run smoothly along any order of the rows.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

from estimator.diagnosis.selection.excess_noise import (
    excess_as_course,
    largest_excess,
    noise_or_course,
    with_unknown_noise,
)
from estimator.diagnosis.selection.ranking import joint_log_evidence, on_other_sensors, strongest
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.selection.start import restart_with_known_noise
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance
from estimator.diagnosis.signatures.traces import Group

DECISIVE = 4.0
"""ln evidence by which a signature must beat mere excess noise to be believed without a look at the scatter: odds of
fifty, since noise needs no choice among thousands of shapes (docs/diagnosis/study.md, structure outside the catalogue).
"""

MOST = 8
"""Different causes (and, apart from them, patterns) looked for in one session, each on as many sensors as show it: far
more than sessions hold, so that the search ends."""


def forward_selection(state: SearchState) -> SearchState:
    """Add causes until none is significant."""
    while len({f.best.cause.identifier for f in state.detections}) < MOST:
        noisy, best = largest_excess(state), strongest(state, state.traces)
        if noisy is not None and (best is None or noisy.log_evidence > best.cause_log_evidence - DECISIVE):
            scatter, best = scatter_or_cause(state, noisy)
            if scatter:
                state = restart_with_known_noise(state, scatter)
                continue
        if best is None:
            break
        extended = (*state.detections, best, *on_other_sensors(state, best, state.traces))
        often = repeated_too_often(extended)
        if not often:
            state = replace(state, detections=extended)
        elif all(f.best.cause.repeats > 1 for f in extended if f.best.group in often):
            rare = tuple(f for f in extended if f.best.group not in often)
            state = replace(state, detections=rare, refuted=state.refuted | often)
        else:
            break
    return state


def scatter_or_cause(
    state: SearchState, noisy: ExcessVariance
) -> tuple[tuple[ExcessVariance | Autocorrelation, ...], Detection | None]:
    """Explains a sensor's scatter: as noise or a course, or by the cause that stands out; neither where it is a
    pattern.
    """
    doubting = in_own_scatter(state, noisy)
    best = strongest(doubting, doubting.traces)
    course = excess_as_course(doubting, noisy)
    if best is None:
        return () if holds_pattern(state, doubting, noisy) else noise_or_course(noisy, course), None
    if course is not None and course.log_evidence > max(best.cause_log_evidence, log_evidence_of_two(doubting, best)):
        return (course,), None
    return (), best


def in_own_scatter(state: SearchState, noisy: ExcessVariance) -> SearchState:
    """The search without belief in a sensor's stated noise; where nothing is found yet, begun anew in what the sensor
    scatters, since one that is believed too much pulls what all share of a row to its readings."""
    return with_unknown_noise(state, noisy.sensor) if state.detections else restart_with_known_noise(state, (noisy,))


def log_evidence_of_two(doubting: SearchState, first: Detection) -> float:
    """ln evidence of a cause and of the strongest other one beside it, while the noise of a sensor is not believed."""
    state = replace(doubting, detections=(*doubting.detections, first))
    second = strongest(state, [t for t in state.traces if t.cause is not first.best.cause])
    state = state if second is None else replace(state, detections=(*state.detections, second))
    return joint_log_evidence(state) - joint_log_evidence(doubting)


def repeated_too_often(detections: Sequence[Detection]) -> frozenset[Group]:
    """Causes named on a sensor more often than they can act there: then it is not that cause."""
    times = Counter(f.best.group for f in detections)
    return frozenset(f.best.group for f in detections if times[f.best.group] > f.best.cause.repeats)


def holds_pattern(state: SearchState, doubting: SearchState, noisy: ExcessVariance) -> bool:
    """Whether a sensor's scatter holds a pattern: one of its own that stands out of it, or one common to all sensors
    that explains more than this sensor's noise does."""
    patterns = [t.at((noisy.sensor,)) for t in doubting.patterns if not t.common]
    shared = strongest(state, [t for t in state.patterns if t.common])
    return strongest(doubting, patterns) is not None or (
        shared is not None and shared.cause_log_evidence > noisy.log_evidence
    )


def with_structures(state: SearchState) -> SearchState:
    """Add patterns without a name in what the causes leave, until none is significant."""
    for _ in range(MOST):
        pattern = strongest(state, state.patterns)
        if pattern is None:
            break
        others = on_other_sensors(state, pattern, state.patterns)
        state = replace(state, structures=(*state.structures, pattern, *others))
    return state
