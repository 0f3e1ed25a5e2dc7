"""The search for the terms of a group's model, and the evidence of every hypothesis beside them.

The likeliest hypothesis joins the model, a cause or a course without a name alike, while the e-value of the group,
given what it has, reaches 1/α. Then every term is weighed again given the others: it leaves where they make it
needless, or gives its place to a likelier one, until nothing changes. A term must hold without any one session, and one
on a type or a stand without any one unit: what one shows by itself is its own affair, and is left free there.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from estimator.groups.evidence import beginnings, first_seen, log_bayes, log_since, log_sum, log_varying
from estimator.groups.pool import Given, GroupHypothesis, GroupTerm, Place, Pool, PoolMoments
from estimator.groups.priors import (
    ENOUGH,
    FEW,
    FORMS,
    LARGEST,
    MOST,
    SAME,
    SINCE,
    STAND,
    STILL,
    UNIT,
    VARYING,
)
from estimator.groups.scores import LEFT, batch
from estimator.least_squares import inverse
from estimator.session import Array
from estimator.significance import p_value


@dataclass(frozen=True, eq=False)
class WeighedMoments:
    """H hypotheses of one width, weighed."""

    statistic: Array
    """(H,) χ² of the pool."""
    forms: Array
    """(3, H) ln Bayes factor, the form's prior share included."""
    since: Array
    """(H,) int: the session at which an effect that began is most likely to have begun."""
    log_evidence: Array
    """(H,) ln of prior share times Bayes factor, all forms together."""


@dataclass(frozen=True, eq=False)
class WeighedPool:
    """All hypotheses of a pool given a model, weighed, by width."""

    given: Given
    widths: dict[int, WeighedMoments]

    @property
    def log_e_value(self) -> float:
        """ln of the e-value of the group: of the names, against nothing at all beside the model."""
        pool = self.given.pool
        named = {w: np.array([not h.nameless for h in table], bool) for w, table in pool.hypotheses.items()}
        values = np.concatenate([x.log_evidence[named[w]] for w, x in self.widths.items()])
        prior = min(1.0, sum(float(np.exp(pool.log_prior[w][named[w]]).sum()) for w in self.widths))
        with np.errstate(divide="ignore"):
            return float(log_sum(np.append(values, np.log1p(-prior))))

    def ranked(self, nameless: bool = False) -> list[tuple[Place, GroupHypothesis, float]]:
        """The best shape of every name, or of every course without one, with the ln evidence of all its shapes,
        strongest first."""
        groups: dict[tuple[str, ...], list[tuple[float, Place, GroupHypothesis]]] = {}
        for w, x in self.widths.items():
            for k, value in enumerate(x.log_evidence.tolist()):
                h = self.given.pool.hypotheses[w][k]
                if np.isfinite(value) and h.nameless == nameless:
                    groups.setdefault(h.group, []).append((value, (w, k), h))
        best = [(max(g, key=lambda x: x[0]), float(np.logaddexp.reduce([x[0] for x in g]))) for g in groups.values()]
        return [(place, h, value) for (_, place, h), value in sorted(best, key=lambda x: -round(x[1], 9))]

    def evidence_of(self, place: Place) -> float:
        """ln evidence of a hypothesis."""
        return float(self.widths[place[0]].log_evidence[place[1]])

    def term(self, place: Place) -> GroupTerm:
        """A hypothesis as a term in its likeliest form."""
        w, k = place
        form = int(np.argmax(self.widths[w].forms[:, k]))
        since = int(self.widths[w].since[k]) if form == SINCE else 0
        return GroupTerm(place, self.given.pool.acting(place, since), form != VARYING, since)


def weigh(given: Given, barred: frozenset[tuple[str, ...]] = frozenset()) -> WeighedPool:
    """Weigh every hypothesis beside a model; ``barred`` groups have no part."""
    return WeighedPool(given, {w: _weighed(given.pool, w, m, barred) for w, m in given.moments.items()})


def _weighed(pool: Pool, w: int, m: PoolMoments, barred: frozenset[tuple[str, ...]]) -> WeighedMoments:
    alone = m.F.sum(axis=0)
    F = alone - m.lost
    gone = np.asarray((np.diagonal(F, axis1=1, axis2=2) <= LEFT * np.diagonal(alone, axis1=1, axis2=2)).all(axis=1))
    F = np.where(gone[:, None, None], 0.0, F)
    U, evidence = (np.where(gone[:, None], 0.0, x.sum(axis=0)) for x in (m.U, m.U * m.shrink))
    forms, since = weighed_forms(m.U * m.shrink, m.F, evidence, F)
    # A course without a name that is not always the same is no law.
    forms[VARYING:, [h.nameless for h in pool.hypotheses[w]]] = -np.inf
    forms[:, gone] = np.log(FORMS)[:, None]
    prior = pool.log_prior[w].copy()
    prior[[h.group in barred for h in pool.hypotheses[w]]] = -np.inf
    return WeighedMoments(batch(U, F)[0], forms, since, prior + log_sum(forms))


def weighed_forms(u: Array, f: Array, U: Array, F: Array) -> tuple[Array, Array]:
    """(3, H) ln Bayes factor in each form, its prior share included, and (H,) the likeliest session of a beginning.

    ``u`` (n, H, w) scores and ``f`` (n, H, w, w) information of the sessions; ``U`` (H, w) and ``F`` (H, w, w)
    of the pool.
    """
    n, H, w = u.shape
    forms = np.full((3, H), -np.inf)
    since = np.zeros(H, dtype=int)
    forms[SAME] = log_bayes(U, F, first_seen(f)) + np.log(FORMS[SAME])
    each = batch(u.reshape(n * H, w), f.reshape(n * H, w, w))
    forms[VARYING] = log_varying(*(x.reshape(n, H).sum(axis=0) for x in each)) + np.log(FORMS[VARYING])
    began = log_since(u, f)
    if len(began):
        forms[SINCE] = log_sum(began) + np.log(FORMS[SINCE])
        since = np.array(beginnings(n))[began.argmax(axis=0)]
    return forms, since


@dataclass(frozen=True, eq=False)
class GroupModel:
    """What a search found in a pool."""

    pool: Pool
    terms: tuple[GroupTerm, ...] = ()
    own: tuple[GroupTerm, ...] = ()
    """Effects that one session, or the sessions of one unit, have by themselves."""
    aside: tuple[GroupTerm, ...] = ()
    """Whatever acts at places that no cause describes, left free in every session."""
    barred: frozenset[tuple[str, ...]] = frozenset()
    """Hypotheses that are not tried, or do not hold."""

    def weighed(self, without: GroupTerm | None = None) -> WeighedPool:
        """All hypotheses given every term, one left out."""
        return weigh(self.given(without), self.barred)

    def given(self, without: GroupTerm | None = None) -> Given:
        """The pool given every term, one left out."""
        return self.pool.given([*self.own, *self.aside, *(t for t in self.terms if t is not without)])

    @property
    def named(self) -> list[GroupTerm]:
        """The terms that have a name."""
        return [t for t in self.terms if not self.pool[t.place].nameless]

    @property
    def nameless(self) -> list[GroupTerm]:
        """The terms that no cause describes."""
        return [t for t in self.terms if self.pool[t.place].nameless]


def search(model: GroupModel) -> GroupModel:
    """The model with all the terms that its pool shows."""
    for _ in range(5 * MOST):
        further = None if len(model.terms) >= MOST else added(model)
        if further is None:
            further = reconsidered(model)
        if further is None:
            break
        model = further
    return model


def added(model: GroupModel, without: GroupTerm | None = None) -> GroupModel | None:
    """The model with the likeliest further term in place of one, or without what does not hold; None where nothing is
    enough."""
    weighed = model.weighed(without)
    best = next(_enough(weighed), None)
    if best is None:
        return None
    place, h = best
    term = weighed.term(place)
    alone = shown_by_one(weighed.given, term)
    if alone is None and within_reason(weighed.given, place):
        return replace(model, terms=(*(t for t in model.terms if t is not without), term))
    often = sum(t.place == place for t in model.own) >= max(1, len(model.pool.parts) // FEW)
    if alone is None or often:
        return replace(model, barred=model.barred | {h.group})
    return replace(model, own=(*model.own, GroupTerm(place, alone, False)))


def _enough(weighed: WeighedPool) -> Iterator[tuple[Place, GroupHypothesis]]:
    """The likeliest hypothesis that may join: a name where the names together reach 1/α, a course where it does."""
    found = [weighed.ranked(nameless)[:1] for nameless in (False, True)]
    sure = (weighed.log_e_value, found[1][0][2] if found[1] else -np.inf)
    likely = [x[0] for x, log_e in zip(found, sure, strict=True) if x and log_e >= ENOUGH]
    yield from ((place, h) for place, h, _ in sorted(likely, key=lambda x: -x[2]))


def reconsidered(model: GroupModel) -> GroupModel | None:
    """The model with one term dropped or in favour of a likelier one; None where each holds given the others."""
    for term in model.terms if len(model.terms) > 1 else ():
        again = added(model, term)
        fewer = replace(model, terms=tuple(t for t in model.terms if t is not term))
        if again is None:
            return fewer
        if again.own != model.own or again.barred != model.barred:
            return replace(again, terms=fewer.terms)
        if again.pool[again.terms[-1].place].group != model.pool[term.place].group:
            return again
    return None


def shown_by_one(given: Given, term: GroupTerm) -> tuple[int, ...] | None:
    """The sessions of the one unit without which the others do not show a term any more; None where they do.

    An effect of a unit, and of a stand where only one unit was measured, must hold without any one session.
    """
    w, k = term.place
    m, units = given.moments[w], [part.subjects[0] for part in given.pool.parts]
    U, F = m.U[:, k] * m.shrink[:, k], m.F[:, k]
    level = given.pool[term.place].level
    by_session = level == UNIT or (level == STAND and len(set(units)) == 1)
    names = list(map(str, range(len(units)))) if by_session else units
    of_one = np.array([[name == other for name in names] for other in dict.fromkeys(names)])
    if term.shared:
        counted = ~of_one & np.isin(np.arange(len(U)), term.sessions)
        statistic, freedom = batch(np.tensordot(counted, U, axes=1), np.tensordot(counted, F, axes=1))
    else:
        statistic, freedom = (x @ ~of_one.T for x in batch(U, F))
    chance = np.array([p_value(float(t), int(q)) if q > 0 else 1.0 for t, q in zip(statistic, freedom, strict=True)])
    most = int(chance.argmax())
    return None if chance[most] < STILL else tuple(np.flatnonzero(of_one[most]).tolist())


def within_reason(given: Given, place: Place) -> bool:
    """Whether the amplitude that fits best is a small part of the applied vector."""
    w, k = place
    m = given.moments[w]
    amplitude = np.abs(inverse(m.F[:, k].sum(axis=0) - m.lost[k]) @ m.U[:, k].sum(axis=0))
    known = [(part, c) for part in given.pool.parts if (c := part.columns_of(place)) is not None]
    return all(bool(np.all(part.reach[c] * amplitude < LARGEST)) for part, c in known)
