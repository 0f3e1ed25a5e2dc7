"""Causes that fit as well as the named one, and the measurement that would tell them apart."""

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp

from estimator.causes.catalogue import UNEXPLAINED
from estimator.diagnosis.explanation.extended_model import joint_amplitude
from estimator.diagnosis.explanation.next_measurement import proposals
from estimator.diagnosis.posterior.explained import Detection, ExplainedSession, Scored
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.results import Rival, Separation
from estimator.least_squares import least_squares
from estimator.session import Array

CREDIBLE = 0.995
"""Share of the probability that the named cause and its alternatives hold together: a true cause is then missing from
the list in one session of two hundred."""

DISTINGUISHED = 5.0
"""Separation, standard errors, at which two causes are distinguished: a likelihood ratio of e^12.5, beyond what the
choice among a catalogue and its shapes can make up."""

NOTICEABLE = 0.1
"""Expected separation, standard errors, below which a measurement is not proposed: 2500 of it would be needed, and
where the rival absorbs everything what is left is rounding."""

WORTH = 1e-3
"""p-value of a rival by itself below which it explains anything."""

SHOWN = 8
"""Lines of the ranking that people see."""


def probabilities(detection: Detection) -> list[tuple[Scored, float]]:
    """Every (cause, sensors) with its share, strongest first."""
    values = np.array([value for _, value in detection.ranking])
    return [(s, float(p)) for (s, _), p in zip(detection.ranking, np.exp(values - logsumexp(values)), strict=True)]


def alternatives(state: ExplainedSession, detection: Detection) -> list[Scored]:
    """Rivals that the session cannot distinguish from the named cause, most likely first.

    A rival with more amplitudes that contains the named cause pays for each of them in its share:
    it is listed where it is still likely after that, and else parsimony has ruled it out. One that is the named cause
    and more of the same (`Cause.contains`) says nothing else. What by itself would be no
    evidence of an effect explains nothing and is no alternative, nor is what lies too far from the named cause.
    """
    chosen: list[Scored] = []
    reached, attributed = 0.0, state.attributed(without=detection)
    amplitude, columns = joint_amplitude(state, detection)
    for rival, share in probabilities(detection):
        if reached >= CREDIBLE:
            break
        reached += share
        known = {detection.best.cause.identifier, *(k.cause.identifier for k in chosen)}
        is_other = rival.cause.identifier not in known and detection.best.cause.identifier not in rival.cause.contains
        near = separation(columns @ amplitude, rival.trace, attributed) < DISTINGUISHED
        if is_other and rival.p_value < WORTH and near:
            chosen.append(rival)
    return chosen


def separation(signature: Array, rival: Array, attributed: Array) -> float:
    """Norm of the residual of a signature (n,), standard errors, after the best fit of a rival's trace (n, q).

    ``attributed`` (n, f) orthonormal traces of the other findings, projected out of the rival's.
    """
    columns = rival - attributed @ (attributed.T @ rival)
    return float(np.sqrt(least_squares(columns, signature).chi2))


def separations(state: ExplainedSession, detection: Detection, others: Sequence[Scored]) -> tuple[Separation, ...]:
    """The present separation of every alternative, and the measurement that would bring it to `DISTINGUISHED`."""
    attributed = state.attributed(without=detection)
    amplitude, columns = joint_amplitude(state, detection)
    signature = columns @ amplitude
    answers = []
    for rival in others:
        now = separation(signature, rival.trace, attributed)
        measurement, apart = proposal(state.baseline, detection.best, amplitude, rival)
        sensors = tuple(state.names[i] for i in rival.sensors)
        answers.append(Separation(rival.cause.identifier, sensors, now, measurement, apart))
    return tuple(answers)


def proposal(baseline: Baseline, named: Scored, amplitude: Array, rival: Scored) -> tuple[str, float | None]:
    """The first proposed measurement that distinguishes two causes, else the best of them; in words, with what to
    expect; nothing where no proposal brings a `NOTICEABLE` separation. ``amplitude`` (q,) of the named one, SI."""
    best: tuple[str, float | None] = ("", None)
    for words, planned in proposals(baseline):
        expected = expected_separation(planned, named, amplitude, rival)
        if expected is not None and expected >= NOTICEABLE and expected > (best[1] or 0.0):
            best = (words, expected)
        if expected is not None and expected >= DISTINGUISHED:
            break
    return best


def expected_separation(planned: Baseline, named: Scored, amplitude: Array, rival: Scored) -> float | None:
    """Separation of the named cause, at its ``amplitude`` (q,), SI, from the rival in a planned session."""
    residuals = WhitenedResiduals.of(planned)
    named_columns, other = (s.columns_in(planned.setting) for s in (named, rival))
    if named_columns is None or other is None:
        return None
    signature = residuals.trace(named_columns) @ amplitude[: named_columns.shape[-1]]
    nothing = np.zeros((len(signature), 0))
    return separation(signature, residuals.trace(other), nothing)


def ranking(state: ExplainedSession, detection: Detection) -> tuple[Rival, ...]:
    """The strongest causes, as people see them, and among them one outside the catalogue where it is possible."""
    known = [
        Rival(s.cause.identifier, tuple(state.names[i] for i in s.sensors), (1 - detection.unnamed) * p, s.strength)
        for s, p in probabilities(detection)[:SHOWN]
    ]
    unknown = [Rival(UNEXPLAINED, (), detection.unnamed, 0.0)] if detection.unnamed > 1 - CREDIBLE else []
    return tuple(sorted((*known, *unknown), key=lambda rival: -rival.probability))
