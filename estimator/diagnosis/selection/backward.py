"""Backward elimination: findings that lose their significance, or that another explanation makes needless, go."""

from dataclasses import replace

import numpy as np
from scipy.special import expit

from estimator.diagnosis.selection.excess_noise import overdispersed
from estimator.diagnosis.selection.ranking import (
    conditional_log_evidence,
    conditional_p_value,
    joint_log_evidence,
    strongest,
)
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.signatures.autocorrelation import autocorrelation
from estimator.diagnosis.signatures.scores import rescored

NAMELESS = 1.5
"""ln evidence by which structure without a name must beat the named causes: it balances names withdrawn from true
causes against names for what is outside the catalogue (docs/diagnosis/study.md, both tables)."""

TWO_FAULTS = 3.0
"""ln evidence by which a cause together with more noise must beat one smooth course: two faults at once on one sensor
are so much rarer than one."""

FURTHER = float(np.log(100))
"""ln evidence that every name beyond the first costs: one misfortune in a hundred sessions has another, independent
one beside it."""

MOST_AT_ONCE = 2
"""Names on one sensor that are believed: more of them patch up one cause that is missing."""

MERGING = 0.1
"""Probability at least that two names on one sensor are one cause that is missing: a second, independent misfortune of
the same sensor is no less rare than that."""

NEEDLESS = 4.0
"""ln evidence by which a sensor's drift must improve on an effect that lasted to be kept beside it: odds of fifty,
since drift has the free parameters to take up what any other effect leaves."""


def penalised_log_evidence(state: SearchState) -> float:
    """ln evidence of the names and structures found together against nothing, every further one paid for."""
    return joint_log_evidence(state) - FURTHER * max(state.misfortunes - 1, 0)


def backward_elimination(state: SearchState) -> SearchState:
    """Every finding keeps its significance beside all others, or goes, the weakest first; a sensor of an event that
    several share has that of the event."""
    while state.detections:
        again = [rescored(state.residuals, f.best, state.attributed(without=f)) for f in state.detections]
        p_value, weakest = max(
            (conditional_p_value(f, s, state.families), k)
            for k, (f, s) in enumerate(zip(state.detections, again, strict=True))
        )
        if p_value < state.level:
            break
        state = replace(state, detections=state.detections[:weakest] + state.detections[weakest + 1 :])
    return state


def without_needless_drift(state: SearchState) -> SearchState:
    """Take back a sensor's drift where another effect on that sensor, part of the history too, explains its change."""
    for drift in [f for f in state.detections if f.best.cause.moves_parameters]:
        rest = replace(state, detections=tuple(f for f in state.detections if f is not drift))
        for other in [f for f in rest.detections if f.best.sensors == drift.best.sensors]:
            again = strongest(rest, rest.traces, without=other)
            if again is None or again.best.cause.moves_parameters:
                continue
            rival = replace(rest, detections=tuple(again if f is other else f for f in rest.detections))
            if joint_log_evidence(rival) > joint_log_evidence(state) - NEEDLESS:
                state = rival
                break
    return state


def without_names_on_courses(state: SearchState) -> SearchState:
    """Withdraw names on one sensor where its residual without them is as likely a smooth course of no name.

    Of several names every further one is a misfortune of its own, and a name that leaves more scatter than the sensor's
    noise is two faults at once. Where the names are kept, the course's probability stays beside them.
    """
    m, noisy = state.sensor_count, overdispersed(state)
    for i in range(m):
        names = tuple(f for f in state.detections if f.best.sensors == (i,))
        if not names:
            continue
        rest = replace(state, detections=tuple(f for f in state.detections if f not in names))
        attributed = rest.attributed()
        course = autocorrelation(rest.residuals, attributed, i, known=not state.baseline.unstated[i])
        if course is None:
            continue
        need = conditional_log_evidence(rest.residuals, attributed, names) - FURTHER * (len(names) - 1)
        gained = course.log_evidence - np.log(m) - need
        if gained > (-TWO_FAULTS if noisy[i] else NAMELESS) or len(names) > MOST_AT_ONCE:
            scatter = [e for e in state.excess if e.sensor == i]
            ratio, larger = float(np.prod([e.ratio for e in scatter])), float(sum(e.log_evidence for e in scatter))
            excess = tuple(e for e in rest.excess if e.sensor != i)
            others = tuple(s for s in rest.autocorrelated if s.sensor != i)
            course = replace(course, ratio=ratio, excess_log_evidence=larger)
            state = replace(rest, excess=excess, autocorrelated=(*others, course))
        else:
            doubt = max(float(expit(gained)), MERGING if len(names) > 1 else 0.0)
            detections = tuple(replace(f, unnamed=max(f.unnamed, doubt)) if f in names else f for f in state.detections)
            state = replace(state, detections=detections)
    return state
