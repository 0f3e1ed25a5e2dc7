"""Which causes fit as well as the named one, and the measurement that would tell them apart."""

from collections.abc import Sequence

import numpy as np
from scipy.special import logsumexp

from estimator.causes import Signature
from estimator.diagnosis.explanation.next_measurement import PROPOSALS
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import Evidence
from estimator.diagnosis.results import Rival, Separation
from estimator.diagnosis.selection.search_state import Found, Search
from estimator.diagnosis.signatures.scores import WORTH, Scored
from estimator.session import Array

CREDIBLE = 0.995
"""Share of the probability that the named cause and its alternatives hold together."""

APART = 5.0
"""Separation, standard errors, at which two causes are told apart."""


def probabilities(found: Found) -> list[tuple[Scored, float]]:
    """Every (cause, sensors) with its share, strongest first."""
    values = np.array([value for _, value in found.ranking])
    return [(s, float(p)) for (s, _), p in zip(found.ranking, np.exp(values - logsumexp(values)), strict=True)]


def alternatives(found: Found) -> list[Scored]:
    """Rivals that the session cannot tell from the named cause, most likely first.

    A rival with more amplitudes that contains the named cause pays for each of them in its share (`bayes_factor`):
    it is listed where it is still likely after that, and else parsimony has ruled it out. What by itself would be no
    evidence of an effect explains nothing and is no alternative.
    """
    kept: list[Scored] = []
    reached = 0.0
    for rival, share in probabilities(found):
        if reached >= CREDIBLE:
            break
        reached += share
        known = {found.best.cause.identifier, *(k.cause.identifier for k in kept)}
        if rival.cause.identifier not in known and rival.p_value < WORTH:
            kept.append(rival)
    return kept


def fitted_trace(state: Search, found: Found, taken: Array) -> Array:
    """(n,) what the named cause leaves in the whitened readings at its fitted amplitude."""
    columns = found.best.columns - taken @ (taken.T @ found.best.columns)
    value, *_ = np.linalg.lstsq(columns, state.evidence.z, rcond=1e-6)
    return np.asarray(columns @ value)


def separation(signature: Array, rival: Array, taken: Array) -> float:
    """Norm of what is left of a signature (n,) after the best fit of a rival's trace (n, q)."""
    columns = rival - taken @ (taken.T @ rival)
    scale = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    value, *_ = np.linalg.lstsq(columns / scale, signature, rcond=1e-9)
    return float(np.linalg.norm(signature - columns / scale @ value))


def separations(state: Search, found: Found, others: Sequence[Scored]) -> tuple[Separation, ...]:
    """For every alternative: how far it is now, and what would bring it to `APART`."""
    taken = state.taken(without=found)
    signature = fitted_trace(state, found, taken)
    names = [s.name for s in state.baseline.session.sensors]
    answers = []
    for rival in others:
        now = separation(signature, rival.columns, taken)
        measurement, then = proposal(state, found, rival)
        sensors = tuple(names[i] for i in rival.shape.sensors)
        answers.append(Separation(rival.cause.identifier, sensors, now, measurement, then))
    return tuple(answers)


def amplitude(state: Search, found: Found) -> Array:
    """(q,) fitted amplitudes of one finding, given the others."""
    taken = state.taken(without=found)
    columns = found.best.columns - taken @ (taken.T @ found.best.columns)
    value, *_ = np.linalg.lstsq(columns, state.evidence.z, rcond=1e-6)
    return np.asarray(value)


def proposal(state: Search, found: Found, rival: Scored) -> tuple[str, float | None]:
    """The first proposed measurement that tells the two apart, else the best of them; in words, with what to expect."""
    best: tuple[str, float | None] = ("", None)
    value = amplitude(state, found)
    for words, planned in (p for propose in PROPOSALS for p in propose(state.baseline)):
        expected = expected_separation(planned, found.best, value, rival)
        if expected is not None and (best[1] is None or expected > best[1]):
            best = (words, expected)
        if expected is not None and expected >= APART:
            break
    return best


def expected_separation(planned: Baseline, named: Scored, value: Array, rival: Scored) -> float | None:
    """Separation of the named cause, at its amplitude, from the rival in a planned session."""
    evidence = Evidence.of(planned)
    own, other = (matching(planned, s) for s in (named, rival))
    if own is None or other is None:
        return None
    signature = evidence.trace(own) @ value[: own.shape[-1]]
    nothing = np.zeros((len(signature), 0))
    return separation(signature, evidence.trace(other), nothing)


def matching(planned: Baseline, scored: Scored) -> Array | None:
    """The cause's columns (R, m, q) in a planned session, at the same sensors and nonlinear parameters."""
    cause = scored.cause
    if not isinstance(cause, Signature) or not cause.available(planned.setting):
        return None
    return cause.columns(planned.setting, scored.shape)


def ranking(state: Search, found: Found, most: int = 8) -> tuple[Rival, ...]:
    """The strongest causes, as people see them."""
    names = [s.name for s in state.baseline.session.sensors]
    return tuple(
        Rival(s.cause.identifier, tuple(names[i] for i in s.shape.sensors), p, s.strength)
        for s, p in probabilities(found)[:most]
    )
