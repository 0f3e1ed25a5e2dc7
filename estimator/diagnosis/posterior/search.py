"""The likeliest set of terms: the best of adding, dropping or replacing, until nothing gains."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.priors import FURTHER, MOST
from estimator.diagnosis.posterior.term import Kind, PlaceCandidate, Term

GAIN = 0.1
"""ln posterior that a change must gain: less decides nothing."""

FEW = 2
"""Causes that are tried together before anything else: what takes more is rarely said by names alone."""


REPEATS = 3
"""Times that a cause may act at one place, each in a shape of its own: more of it is something else."""

HOPELESS = 30.0
"""ln posterior odds by which terms may be behind that dropping and replacing can still make up."""


@dataclass(frozen=True, eq=False)
class Remainder:
    """The information left beside some terms, their ln posterior odds against none, and all candidates there."""

    terms: tuple[Term, ...]
    info: InputInformation
    log_posterior: float
    misfortunes: int
    """Number of things that are known to have happened already."""
    known: dict[Kind, list[PlaceCandidate]] = field(default_factory=dict)

    def candidates(self, kinds: Iterable[Kind]) -> list[PlaceCandidate]:
        """The candidates of some kinds."""
        found: list[PlaceCandidate] = []
        for kind in kinds:
            if kind not in self.known:
                each = kind.candidates(self.info)
                self.known[kind] = [c.beside_others() for c in each] if self.misfortunes else each
            found += self.known[kind]
        return found

    def best(self, kinds: Iterable[Kind]) -> PlaceCandidate | None:
        """The likeliest one whose place is not taken; a cause of the catalogue may act so often with other shapes."""
        taken = Counter(t.place for t in self.terms)
        free = (c for c in self.candidates(kinds) if taken[c.place] < (REPEATS if c.named else 1))
        return max(free, key=lambda c: c.value, default=None)


@dataclass(frozen=True, eq=False)
class TermModel:
    """The kinds of terms of a session and its information with nothing found."""

    start: InputInformation
    of_causes: tuple[Kind, ...]
    """Kinds of causes of the catalogue, each on one sensor or in the stand."""
    of_others: tuple[Kind, ...]
    """Kinds of everything else."""
    misfortunes: int = 0
    """Number of things that are known to have happened, beside what is sought."""
    known: dict[frozenset[int], Remainder] = field(default_factory=dict)

    @property
    def kinds(self) -> tuple[Kind, ...]:
        """All kinds of terms."""
        return self.of_causes + self.of_others

    def beside(self, terms: Sequence[Term]) -> Remainder:
        """The remainder beside some terms."""
        key = frozenset(map(id, terms))
        if key not in self.known:
            info, value = self.start, 0.0
            for term in terms:
                info, gained = info.given(term.columns, term.variance, term.mean)
                value += gained + term.log_prior + term.log_place
            count = self.misfortunes + len(terms)
            further = min(len(terms), max(count - 1, 0))
            self.known[key] = Remainder(tuple(terms), info, value + further * FURTHER, count)
        return self.known[key]


def search(model: TermModel) -> tuple[Term, ...]:
    """The likeliest terms that are reached from nothing, and from the causes that alone would make most of the session.

    A course that is taken first, of one sensor or of several, may hide what several causes explain together.
    """
    whole = climbed(model, model.kinds)
    if all(term.named and len(term.sensors) < 2 for term in whole):
        return whole
    rival = grown(model, model.kinds, grown(model, model.of_causes, (), FEW), MOST)
    if model.beside(rival).log_posterior < model.beside(whole).log_posterior - HOPELESS:
        return whole
    return max((whole, climbed(model, model.kinds, rival)), key=lambda terms: model.beside(terms).log_posterior)


def climbed(model: TermModel, kinds: Sequence[Kind], start: Sequence[Term] = ()) -> tuple[Term, ...]:
    """The likeliest terms of some kinds, climbed to from ``start``: added as long as that gains, then dropped or
    replaced."""
    terms = grown(model, kinds, start, MOST)
    for _ in range(4 * MOST):
        better = replaced(model, kinds, model.beside(terms))
        if better is None:
            break
        terms = grown(model, kinds, better, MOST)
    return terms


def grown(model: TermModel, kinds: Sequence[Kind], start: Sequence[Term], most: int) -> tuple[Term, ...]:
    """The terms of ``start`` and those that gain beside them, the likeliest first, ``most`` in all."""
    terms = tuple(start)
    while len(terms) < most:
        new = model.beside(terms).best(kinds)
        if new is None or new.value <= GAIN:
            break
        terms = (*terms, new.term())
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
        if new is not None and new.value - lost > best:
            best, found = new.value - lost, (*rest, new.term())
    return found


def groups(terms: Sequence[Term]) -> list[tuple[Term, ...]]:
    """Sets of terms that one other may replace: each alone, those of a place, of a name, and all."""
    sets: list[tuple[Term, ...]] = [(t,) for t in terms]
    sets += [tuple(t for t in terms if t.sensors == sensors) for sensors in {t.sensors for t in terms}]
    sets += [tuple(t for t in terms if t.name == name) for name in {t.name for t in terms}]
    sets.append(tuple(terms))
    return list({frozenset(map(id, s)): s for s in sets if s}.values())
