"""Which explanations a group's sessions cannot tell from the named one, and how far each is."""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from estimator.diagnosis.explanation.rivals import CREDIBLE, DISTINGUISHED
from estimator.groups.evidence import VARYING
from estimator.groups.layout import Hypothesis
from estimator.groups.pool import Place, Pool, columns_in, extended, pooled, without
from estimator.groups.scores import inverse
from estimator.groups.selection import Found, Selection
from estimator.groups.weighing import Scale
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class Near:
    """A rival of a finding."""

    place: Place
    hypothesis: Hypothesis
    probability: float
    separation: float


def near(selection: Selection, found: Found, scale: Scale) -> list[Near]:
    """Rivals that the pool does not tell from a finding, most likely first; ``scale`` is of the pool without it.

    As within one session: those that hold the bulk of the probability together with it and lie near.
    """
    ranked = list(scale.ranked())
    values = np.array([value for _, _, value in ranked])
    share = np.exp(values - logsumexp(values))
    reached, kept = 0.0, []
    for (place, hypothesis, _), p in zip(ranked, share, strict=True):
        if reached >= CREDIBLE:
            break
        reached += float(p)
        if hypothesis.group == found.hypothesis.group:
            continue
        apart = separation(selection, found, place)
        if apart < DISTINGUISHED:
            kept.append(Near(place, hypothesis, float(p), apart))
    return kept


def separation(selection: Selection, found: Found, rival: Place) -> float:
    """Norm of what is left of a finding's signature, over the sessions that have it, after the best fit of a rival."""
    model = selection.model(without=found)
    scale = selection.scale
    base: Pool = pooled(selection.layout, model, scale)
    w, k = found.place
    U, F = base.moments[w].U[:, k], base.moments[w].F[:, k]
    total = inverse(F[found.since :].sum(axis=0)) @ U[found.since :].sum(axis=0)
    a, b = found.place[0], rival[0]
    own, both, other = np.zeros((a, a)), np.zeros((a, b)), np.zeros((b, b))
    square = 0.0
    for s, part in enumerate(selection.layout.parts):
        if s < found.since:
            continue
        mine, theirs = columns_in(part, found.place), columns_in(part, rival)
        if mine is None:
            continue
        information = _given(selection, found, s)
        f_own = information[np.ix_(mine, mine)]
        f_both = information[np.ix_(mine, theirs)] if theirs is not None else np.zeros((a, b))
        f_other = information[np.ix_(theirs, theirs)] if theirs is not None else np.zeros((b, b))
        if found.form == VARYING:
            amplitude = inverse(F[s]) @ U[s]
            square += _left(amplitude, f_own, f_both, f_other)
        own, both, other = own + f_own, both + f_both, other + f_other
    return float(np.sqrt(max(square if found.form == VARYING else _left(total, own, both, other), 0.0)))


def _given(selection: Selection, found: Found, session: int) -> Array:
    """(E, E) information of a session, what else acts there left free."""
    part = selection.layout.parts[session]
    U, E, F = extended(part, float(selection.scale[session]))
    model = selection.model(without=found)
    places = [p for j, p in model.absorbed if j == session] + [s.place for s in model.shared if session >= s.since]
    free = [c for p in places if (c := columns_in(part, p)) is not None]
    return without(U, E, F, np.unique(np.concatenate(free)).tolist())[2] if free else F


def _left(amplitude: Array, own: Array, both: Array, other: Array) -> float:
    """Squared norm of a signature at an amplitude, less its best fit by another."""
    return float(amplitude @ (own - both @ inverse(other) @ both.T) @ amplitude)
