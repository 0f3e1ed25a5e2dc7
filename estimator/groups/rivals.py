"""Which explanations a group's sessions cannot tell from the named one, and how far each is."""

from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.explanation.rivals import CREDIBLE, DISTINGUISHED
from estimator.groups.evidence import VARYING, log_sum
from estimator.groups.layout import Hypothesis, Layout
from estimator.groups.pool import Place, Pool, columns_in, extended, without
from estimator.groups.selection import Found, Selection
from estimator.groups.weighing import Scale
from estimator.least_squares import inverse
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class Near:
    """A rival of a finding."""

    place: Place
    hypothesis: Hypothesis
    probability: float
    separation: float


@dataclass(frozen=True, eq=False)
class Signature:
    """A finding in every session that has it, what else acts there left free. n sessions, w amplitudes."""

    found: Found
    sessions: tuple[int, ...]
    amplitude: Array
    """(n, w) SI: its own of every session where it differs, else that of the pool."""
    information: tuple[Array, ...]
    """(E, E) 1/SI² of each."""
    layout: Layout

    @classmethod
    def of(cls, selection: Selection, found: Found, base: Pool) -> "Signature":
        """``base`` is the pool without the finding."""
        w, k = found.place
        U, F = base.moments[w].U[:, k], base.moments[w].F[:, k]
        shared = inverse(F[found.since :].sum(axis=0)) @ U[found.since :].sum(axis=0)
        parts = selection.layout.parts
        own = [s for s in range(found.since, len(parts)) if columns_in(parts[s], found.place) is not None]
        each = [inverse(F[s]) @ U[s] if found.form == VARYING else shared for s in own]
        given = tuple(_given(selection, base, s) for s in own)
        return cls(found, tuple(own), np.array(each), given, selection.layout)

    def separation(self, rival: Place) -> float:
        """Norm of what is left of it after the best fit of a rival, of one amplitude or of one in every session."""
        a, b = self.found.place[0], rival[0]
        own, both, other = np.zeros((a, a)), np.zeros((a, b)), np.zeros((b, b))
        square = 0.0
        for s, amplitude, F in zip(self.sessions, self.amplitude, self.information, strict=True):
            mine = columns_in(self.layout.parts[s], self.found.place)
            theirs = columns_in(self.layout.parts[s], rival)
            if mine is None:
                continue
            f_own = F[np.ix_(mine, mine)]
            f_both = F[np.ix_(mine, theirs)] if theirs is not None else np.zeros((a, b))
            f_other = F[np.ix_(theirs, theirs)] if theirs is not None else np.zeros((b, b))
            square += _left(amplitude, f_own, f_both, f_other) if self.found.form == VARYING else 0.0
            own, both, other = own + f_own, both + f_both, other + f_other
        if self.found.form != VARYING:
            square = _left(self.amplitude[0], own, both, other)
        return float(np.sqrt(max(square, 0.0)))


def near(selection: Selection, found: Found, scale: Scale) -> list[Near]:
    """Rivals that the pool does not tell from a finding, most likely first; ``scale`` is of the pool without it.

    As within one session: those that hold the bulk of the probability together with it and lie near.
    """
    ranked = list(scale.ranked())
    values = np.array([value for _, _, value in ranked])
    share = np.exp(values - log_sum(values))
    signature = Signature.of(selection, found, scale.pool)
    reached, kept = 0.0, []
    for (place, hypothesis, _), p in zip(ranked, share, strict=True):
        if reached >= CREDIBLE:
            break
        reached += float(p)
        if hypothesis.group == found.hypothesis.group:
            continue
        apart = signature.separation(place)
        if apart < DISTINGUISHED:
            kept.append(Near(place, hypothesis, float(p), apart))
    return kept


def _given(selection: Selection, base: Pool, session: int) -> Array:
    """(E, E) information of a session, what else acts there left free."""
    part, model = selection.layout.parts[session], base.model
    U, E, F = extended(part, float(selection.scale[session]))
    places = [p for j, p in model.absorbed if j == session] + [s.place for s in model.shared if session >= s.since]
    free = [c for p in places if (c := columns_in(part, p)) is not None]
    if free:
        return without(U, E, F, np.unique(np.concatenate(free)).tolist())[2]
    return F(*np.ix_(range(len(U)), range(len(U))))


def _left(amplitude: Array, own: Array, both: Array, other: Array) -> float:
    """Squared norm of a signature at an amplitude, less its best fit by another."""
    return float(amplitude @ (own - both @ inverse(other) @ both.T) @ amplitude)
