"""The sessions of a group added up: score and information of every hypothesis, given the terms of a model.

A term enters in one of two ways. An amplitude that its sessions share is fitted jointly (`joint_fit`). One that differs
from session to session is left free in each of them.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.groups.joint_fit import JointFit
from estimator.groups.priors import SAME, SINCE, VARYING
from estimator.groups.scores import LEFT
from estimator.groups.statistics import HARMONIC
from estimator.least_squares import given
from estimator.session import Array

LIBRARY = "terms"
"""Takes the place of a cause: a term of the library."""

Place = tuple[int, int]
"""A hypothesis in a pool: its width and its number among those."""

Among = Callable[[Array, Array], Array]
"""Information of a session, 1/SI², of ``rows`` and ``columns``, int, that broadcast: only what is asked is unpacked."""


@dataclass(frozen=True)
class GroupHypothesis:
    """A cause, or an unknown course, of a unit, a type or a stand, at a place, in a shape."""

    level: str
    subject: str
    """Serial of the unit, name of the type or id of the stand."""
    cause: str
    sensor: str
    """Empty for what acts on the applied vector, ``*`` for every sensor of the kind."""
    kind: str
    shape: float | None
    width: int
    words: tuple[str, ...] = ()
    """Factors that the amplitudes of a term of the library multiply."""

    @property
    def nameless(self) -> bool:
        return self.cause in (HARMONIC, LIBRARY)

    @property
    def group(self) -> tuple[str, ...]:
        """The thing that is named: all its shapes are one."""
        return self.level, self.subject, self.cause, self.sensor, self.kind, *self.words


@dataclass(frozen=True, eq=False)
class Part:
    """One session in a pool. E columns."""

    subjects: tuple[str, str, str]
    """Its unit, the unit's type and the stand."""
    scale: float
    """Factor by which the variance exceeds the stated one; taken into account already."""
    score: Array
    """(E,) 1/SI."""
    shrink: Array
    """(E,) at most 1: factor with which a score enters the evidence."""
    reach: Array
    """(E,) largest change of a reading per unit amplitude, as a part of the applied vector."""
    information: Among
    numbers: dict[int, Array]
    """Width → (k,) numbers of the hypotheses of that width that the session speaks of."""
    columns: dict[int, Array]
    """Width → (k, w) their columns here."""

    def columns_of(self, place: Place) -> Array | None:
        """(w,) columns of a hypothesis; None where the session does not speak of it."""
        width, number = place
        matching = np.flatnonzero(self.numbers.get(width, np.zeros(0)) == number)
        return self.columns[width][matching[0]] if len(matching) else None

    def without(self, columns: Iterable[Array]) -> tuple[Array, Among]:
        """Its score and information given some columns left free."""
        free = np.unique(np.concatenate([np.zeros(0, dtype=int), *columns]))
        if not len(free):
            return self.score, self.information
        every = np.arange(len(self.score))
        score, left = given(self.score, self.information(every[:, None], every), free.tolist(), LEFT)
        return score, lambda rows, columns: np.asarray(left[rows, columns])


@dataclass(frozen=True)
class GroupTerm:
    """One effect of a model of the group."""

    place: Place
    sessions: tuple[int, ...]
    """The sessions that it acts in."""
    shared: bool
    """Whether they share one amplitude; else each has its own."""
    since: int = 0
    """The session that it began with."""

    @property
    def form(self) -> int:
        if not self.shared:
            return VARYING
        return SINCE if self.since else SAME


@dataclass(frozen=True, eq=False)
class PoolMoments:
    """Hypotheses of width w in a pool, given a model. n sessions, H hypotheses, a amplitudes in the joint fit."""

    U: Array
    """(n, H, w) scores, 1/SI, given the joint fit."""
    F: Array
    """(n, H, w, w) 1/SI²."""
    cross: Array
    """(n, H, w, a) 1/SI²: information shared with the joint fit."""
    lost: Array
    """(H, w, w) 1/SI²: information of the pool that the joint fit takes."""
    shrink: Array
    """(n, H, w) factors with which the scores enter the evidence."""


@dataclass(frozen=True, eq=False)
class Given:
    """A pool given the terms of a model."""

    pool: "Pool"
    terms: tuple[GroupTerm, ...]
    moments: dict[int, PoolMoments]
    fit: JointFit
    """Fit of the amplitudes that sessions share, term after term."""


@dataclass(frozen=True, eq=False)
class Pool:
    """Hypotheses, by width, and the sessions that speak of them, oldest first."""

    hypotheses: dict[int, tuple[GroupHypothesis, ...]]
    log_prior: dict[int, Array]
    """Width → (H,) ln of the prior share."""
    parts: tuple[Part, ...]

    def __getitem__(self, place: Place) -> GroupHypothesis:
        return self.hypotheses[place[0]][place[1]]

    @cached_property
    def places(self) -> dict[GroupHypothesis, Place]:
        """Every hypothesis with its place."""
        return {h: (w, k) for w, table in self.hypotheses.items() for k, h in enumerate(table)}

    def acting(self, place: Place, since: int = 0) -> tuple[int, ...]:
        """The sessions, from one on, that speak of a hypothesis."""
        rest = range(since, len(self.parts))
        return tuple(k for k in rest if self.parts[k].columns_of(place) is not None)

    def given(self, terms: Sequence[GroupTerm] = ()) -> Given:
        """All sessions added up, given terms."""
        shared = [t for t in terms if t.shared]
        ends = np.cumsum([0, *(t.place[0] for t in shared)])
        n, a = len(self.parts), int(ends[-1])
        fit = JointFit(np.zeros((n, a)), np.zeros((n, a, a)))
        arrays = {
            w: (np.zeros((n, H, w)), np.zeros((n, H, w, w)), np.zeros((n, H, w, a)), np.ones((n, H, w)))
            for w, H in ((w, len(table)) for w, table in self.hypotheses.items())
        }
        for k, part in enumerate(self.parts):
            acting = [(j, t, c) for j, t in enumerate(terms) if k in t.sessions for c in [part.columns_of(t.place)]]
            score, information = part.without(c for _, t, c in acting if not t.shared and c is not None)
            joint = [(shared.index(t), c) for _, t, c in acting if t.shared and c is not None]
            slots = np.concatenate([np.zeros(0, dtype=int), *(np.arange(ends[j], ends[j + 1]) for j, _ in joint)])
            at = np.concatenate([np.zeros(0, dtype=int), *(c for _, c in joint)])
            fit.U[k, slots], fit.F[k][np.ix_(slots, slots)] = score[at], information(at[:, None], at)
            for w, numbers in part.numbers.items():
                U, F, cross, shrink = arrays[w]
                c = part.columns[w]
                U[k, numbers], F[k, numbers] = score[c], information(c[:, :, None], c[:, None, :])
                shrink[k, numbers] = part.shrink[c]
                if len(at):
                    cross[k][numbers[:, None, None], np.arange(w)[:, None], slots] = information(c[:, :, None], at)
        moments = {
            w: PoolMoments(U - fit.explains(cross), F, cross, fit.absorbs(cross), shrink)
            for w, (U, F, cross, shrink) in arrays.items()
        }
        return Given(self, tuple(terms), moments, fit)
