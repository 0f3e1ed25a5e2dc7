"""The signature with the strongest evidence given the other findings, and the evidence of several together."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field

import numpy as np

from estimator.content import held, once
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.search_state import LEVEL, NEW_DIRECTION, Detection, SearchState
from estimator.diagnosis.signatures.scores import Scores, rescored, scores
from estimator.diagnosis.signatures.traces import Scored, Traces
from estimator.session import Array
from estimator.significance import family_wise

TRIED = 3
"""Leaders of a ranking that are asked for significance: the strongest evidence need not have the smallest p-value."""


def family_p_value(scored: Scored, families: int) -> float:
    """p-value of a signature or anything as strong among so many families, were there no effect (Bonferroni)."""
    return family_wise(scored.p_value, scored.places * families)


def conditional_p_value(detection: Detection, again: Scored, families: int) -> float:
    """Family-wise p-value of a finding that was scored ``again`` beside others; of an event's sensor the event's."""
    return detection.p_family if detection.event else family_p_value(again, families)


def strongest(state: SearchState, traces: Sequence[Traces], without: Detection | None = None) -> Detection | None:
    """The signature with the strongest evidence given the other findings; None if it is not significant.

    ``without``: one finding is taken back and chosen anew, on its own sensor or common to all.
    """
    families, level = len(traces), LEVEL
    if traces is state.traces:
        families, level = state.families, state.level_beside([f for f in state.detections if f is not without])
    if without is not None and without.best.sensors:
        traces = [t.at(without.best.sensors) for t in traces]
    closed = {s.sensor for s in state.autocorrelated if s.plain}
    given = scores_given(state, traces, without)
    had = state.refuted | {f.best.group for f in state.detections if f.event and f is not without}
    order = [(k, e) for k, e in given.ranked() if given.sensor[k] not in closed and given.group(k) not in had]
    for best in (given.scored(k) for k, _ in order[:TRIED]):
        p_family = family_p_value(best, families)
        if p_family < level:
            return Detection(best, p_family, tuple((given.scored(k), e) for k, e in order))
    return None


def scores_given(state: SearchState, traces: Sequence[Traces], without: Detection | None) -> Scores:
    """The scores given the other findings. The search comes back to the same findings: those of all that is looked for
    are kept."""
    attributed = state.attributed(without)
    if isinstance(traces, tuple):
        return _known(state.residuals, traces, Known(held(attributed), attributed))
    return scores(state.residuals, traces, attributed)


@dataclass(frozen=True)
class Known:
    """Orthonormal traces, equal to any other of the same bits."""

    key: Hashable
    attributed: Array = field(compare=False)
    """(n, f) dimensionless."""


@once
def _known(residuals: WhitenedResiduals, traces: tuple[Traces, ...], attributed: Known) -> Scores:
    return scores(residuals, traces, attributed.attributed)


def on_other_sensors(state: SearchState, best: Detection, traces: Sequence[Traces]) -> list[Detection]:
    """Detections of the same cause on other sensors, where it leads their own ranking and is significant beside the
    rest.
    """
    leads: dict[tuple[int, ...], Scored] = {}
    for scored, _ in best.ranking:
        leads.setdefault(scored.sensors, scored)
    same = [s for sensors, s in leads.items() if sensors and sensors != best.best.sensors]
    families = state.families if traces is state.traces else len(traces)
    others: list[Detection] = []
    attributed = extended_basis(state.attributed(), best.best.trace)
    for scored in same:
        if scored.cause is not best.best.cause or family_p_value(scored, families) >= LEVEL:
            continue
        p_family = family_p_value(rescored(state.residuals, scored, attributed), families)
        if p_family < LEVEL:
            others.append(Detection(scored, p_family, best.ranking_on(scored.sensors)))
            attributed = extended_basis(attributed, scored.trace)
    return others


def joint_log_evidence(state: SearchState) -> float:
    """ln evidence of everything found together, each weighed on what those before it leave."""
    nothing = np.zeros((len(state.residuals.z), 0))
    return conditional_log_evidence(state.residuals, nothing, (*state.detections, *state.structures))


def conditional_log_evidence(residuals: WhitenedResiduals, attributed: Array, members: Sequence[Detection]) -> float:
    """ln evidence of some findings, each on what others and the stronger of them leave.

    The order matters where the noise is estimated from what is left: the strongest first, whatever they are called.
    ``attributed`` (n, f) orthonormal traces of the others, dimensionless.
    """
    log_evidence = 0.0
    for member in sorted(members, key=lambda f: -rescored(residuals, f.best, attributed).statistic):
        log_evidence += rescored(residuals, member.best, attributed).log_evidence
        attributed = extended_basis(attributed, member.best.trace)
    return log_evidence


def extended_basis(basis: Array, columns: Array) -> Array:
    """(n, f + …) orthonormal, dimensionless: ``basis`` (n, f) continued by what is new in ``columns`` (n, q)."""
    norms = np.linalg.norm(columns, axis=0)
    new = columns[:, norms > 0] / norms[norms > 0]
    for _ in range(2):  # once leaves rounding of what lies almost within the span
        new = new - basis @ (basis.T @ new)
    directions, size, _ = np.linalg.svd(new, full_matrices=False)
    return np.concatenate([basis, directions[:, size > NEW_DIRECTION]], axis=1)
