"""The likeliest set of terms: the best of adding, dropping or replacing, until nothing gains."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.priors import MOST
from estimator.diagnosis.posterior.term import Kind, PlaceCandidate, Term

GAIN = 1e-6
"""ln posterior that a change must gain: rounding is smaller."""


@dataclass(frozen=True, eq=False)
class Remainder:
    """The information left beside some terms, their ln posterior odds against none, and all candidates there."""

    terms: tuple[Term, ...]
    info: InputInformation
    log_posterior: float
    known: dict[Kind, list[PlaceCandidate]] = field(default_factory=dict)

    def candidates(self, kinds: Iterable[Kind]) -> list[PlaceCandidate]:
        """The candidates of some kinds."""
        found: list[PlaceCandidate] = []
        for kind in kinds:
            if kind not in self.known:
                self.known[kind] = kind.candidates(self.info)
            found += self.known[kind]
        return found

    def best(self, kinds: Iterable[Kind]) -> PlaceCandidate | None:
        """The likeliest one whose place is not taken."""
        taken = {t.place for t in self.terms}
        return max((c for c in self.candidates(kinds) if c.place not in taken), key=lambda c: c.value, default=None)


@dataclass(frozen=True, eq=False)
class TermModel:
    """The kinds of terms of a session and its information with nothing found."""

    start: InputInformation
    of_causes: tuple[Kind, ...]
    """Kinds of causes of the catalogue."""
    of_courses: tuple[Kind, ...]
    """Kinds of everything else."""
    known: dict[frozenset[int], Remainder] = field(default_factory=dict)

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """All kinds of terms."""
        return self.of_causes + self.of_courses

    def beside(self, terms: Sequence[Term]) -> Remainder:
        """The remainder beside some terms."""
        key = frozenset(map(id, terms))
        if key not in self.known:
            info, value = self.start, 0.0
            for term in terms:
                info, gained = info.given(term.columns, term.variance, term.mean)
                value += gained + term.log_prior
            self.known[key] = Remainder(tuple(terms), info, value)
        return self.known[key]


def search(model: TermModel) -> tuple[Term, ...]:
    """The likeliest terms that are reached from nothing, and from what causes alone would make of the session."""
    causes = climbed(model, model.of_causes)
    whole = climbed(model, model.kinds, causes)
    if not causes and not whole:
        return whole
    rival = climbed(model, model.kinds)
    return max((whole, rival), key=lambda terms: model.beside(terms).log_posterior)


def climbed(model: TermModel, kinds: Sequence[Kind], start: Sequence[Term] = ()) -> tuple[Term, ...]:
    """The likeliest terms of some kinds, climbed to from ``start``: added as long as that gains, then dropped or
    replaced."""
    terms = tuple(start)
    for _ in range(4 * MOST):
        here = model.beside(terms)
        new = here.best(kinds) if len(terms) < MOST else None
        better = (*terms, new.term()) if new is not None and new.value > GAIN else replaced(model, kinds, here)
        if better is None:
            break
        terms = better
    return terms


def replaced(model: TermModel, kinds: Sequence[Kind], here: Remainder) -> tuple[Term, ...] | None:
    """The terms with some dropped, or one in place of them, whichever gains most; None where nothing gains."""
    best, found = GAIN, None
    for group in groups(here.terms):
        rest = tuple(t for t in here.terms if t not in group)
        there = model.beside(rest)
        lost = here.log_posterior - there.log_posterior
        if -lost > best:
            best, found = -lost, rest
        new = there.best(kinds)
        if new is not None and new.best - lost > best:
            best, found = new.best - lost, (*rest, new.term())
    return found


def groups(terms: Sequence[Term]) -> list[tuple[Term, ...]]:
    """Sets of terms that one other may replace: each alone, those of a place, of a name, and all."""
    sets: list[tuple[Term, ...]] = [(t,) for t in terms]
    sets += [tuple(t for t in terms if t.sensors == sensors) for sensors in {t.sensors for t in terms}]
    sets += [tuple(t for t in terms if t.name == name) for name in {t.name for t in terms}]
    sets.append(tuple(terms))
    return list({frozenset(map(id, s)): s for s in sets if s}.values())
