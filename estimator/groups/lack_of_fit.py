"""A group's names held against the library of empirical terms, place after place.

Where a place's names do not fit they are taken back, the place is left free in every session, and the search is made
anew: what is named elsewhere then holds whatever that place does. Only names are taken back, and none is added by what
the library says: a group without an effect keeps its bound.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

from estimator.groups.beyond import BeyondJudgement, judged
from estimator.groups.layout import TERMS, GroupHypothesis
from estimator.groups.place import Key, PlacedFit, PlaceMoments, Where, key_of, moments_at
from estimator.groups.pool import Place, columns_in
from estimator.groups.selection import Found, GroupSelection, select
from estimator.groups.session_statistics import as_kept
from estimator.session import CalibrationSession

MOST = 4
"""Places whose names are taken back; in a group with more of them little can be said at all."""


@dataclass(frozen=True, eq=False)
class LackOfFitGroup:
    """The sessions of a group, fitted when they are first asked for."""

    selection: GroupSelection
    sessions: tuple[CalibrationSession, ...]
    """The latest ones, as many as are at hand."""

    @property
    def first(self) -> int:
        """Number in the group of the first that is at hand."""
        return len(self.selection.layout.parts) - len(self.sessions)

    @cached_property
    def fitted(self) -> tuple[PlacedFit, ...]:
        """Every session at hand as its record took it."""
        parts = [p.statistics for p in self.selection.layout.parts[self.first :]]
        scales = self.selection.scale[self.first :].tolist()
        return tuple(
            PlacedFit(record, as_kept(session, record), scale)
            for session, record, scale in zip(self.sessions, parts, scales, strict=True)
        )

    def __contains__(self, where: Where) -> bool:
        """Whether a session at hand has a place."""
        parts = self.selection.layout.parts[self.first :]
        return any(where.concerns(p.statistics) for p in parts)

    def moments(self, state: GroupSelection, where: Where) -> PlaceMoments:
        """Causes and terms of a place over its sessions, what was found elsewhere left free."""
        numbers = [k for k, fit in enumerate(self.fitted) if where.concerns(fit.record)]
        beside = [(Where.of(f.hypothesis), key_of(f.hypothesis)) for f in state.found]
        beside += [_at(state, place) for place in state.nameless]
        whole = [(w, key) for w, key in beside if w != where]
        alone = [*state.of_one_session, *state.aside]
        others = [[*whole, *(_at(state, p) for j, p in alone if j == k + self.first)] for k in numbers]
        return moments_at(where, [self.fitted[k] for k in numbers], [[x for x in o if x[0] != where] for o in others])


def _at(state: GroupSelection, place: Place) -> tuple[Where, Key]:
    """A hypothesis as a candidate of its place."""
    h = state.layout.hypotheses[place[0]][place[1]]
    return Where.of(h), key_of(h)


def names_that_fit(group: LackOfFitGroup) -> GroupSelection:
    """The findings that the library does not describe better; what it describes as well is doubted.

    So is every name of a place of which no session is at hand: a record holds the catalogue's scores, and the library's
    would make it five times as large.
    """
    state, settled = group.selection, dict[Where, tuple[GroupHypothesis, BeyondJudgement]]()
    while True:
        judgements = [
            (where, names, judged(group.moments(state, where), names))
            for where, names in by_place(state)
            if where not in settled and where in group
        ]
        wrong = [(where, says) for where, _, says in judgements if not says.fits]
        if not wrong or len(settled) == MOST:
            break
        where, says = max(wrong, key=lambda x: x[1].statistic)
        settled[where] = (GroupHypothesis(*where[:2], TERMS, *where[2:], None, 0, says.words), says)
        state = searched_again(state, where, says)
    unasked = [f for f in state.found if Where.of(f.hypothesis) not in group]
    doubtful = [*unasked, *(f for _, names, says in judgements if says.doubtful for f in names)]
    doubted = frozenset(f.hypothesis.group for f in doubtful)
    nameless = tuple((h, says.statistic) for h, says in settled.values())
    gone = tuple((f, h) for h, says in settled.values() for f in says.taken_back)
    structures, misfits = (*state.structures, *nameless), (*state.misfits, *gone)
    return replace(state, structures=structures, misfits=misfits, doubted=doubted)


def by_place(state: GroupSelection) -> Iterator[tuple[Where, list[Found]]]:
    """The findings of every place."""
    for where in dict.fromkeys(Where.of(f.hypothesis) for f in state.found):
        yield where, [f for f in state.found if Where.of(f.hypothesis) == where]


def searched_again(state: GroupSelection, where: Where, says: BeyondJudgement) -> GroupSelection:
    """The search without a place: it is left free in every session, or for the names that hold there alone."""
    table = [((w, k), h) for w, listed in state.layout.hypotheses.items() for k, h in enumerate(listed)]
    if says.kept:
        kept = {f.hypothesis.group for f in says.kept}
        others = {h.group for _, h in table if Where.of(h) == where} - kept
        return select(state.layout, state.barred | others, state.aside)
    there = [place for place, h in table if (h.sensor, h.kind) == (where.sensor, where.kind)]
    free = tuple(
        (k, place)
        for k, part in enumerate(state.layout.parts)
        if where.concerns(part.statistics)
        for place in there
        if columns_in(part, place) is not None
    )
    return select(state.layout, state.barred, (*state.aside, *free))
