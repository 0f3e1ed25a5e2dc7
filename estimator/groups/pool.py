"""The sessions of a group added up: score and information of every hypothesis, given what was found before.

What is found enters in one of two ways. An amplitude that all sessions share is fitted jointly (`joint_fit`). One that
differs from session to session is *absorbed* in each session by itself, as is what acts in one session only.
"""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.groups.joint_fit import JointFit
from estimator.groups.layout import GroupLayout, Part
from estimator.groups.scores import LEFT
from estimator.least_squares import given
from estimator.session import Array

Place = tuple[int, int]
"""A hypothesis: its width and its number among those."""

Among = Callable[[Array, Array], Array]
"""Information of a session, 1/SI², of ``rows`` and ``columns``, int, that broadcast: only what is asked is unpacked."""


@dataclass(frozen=True)
class SharedColumns:
    """A hypothesis in the joint fit, with one amplitude from some session on."""

    place: Place
    since: int = 0


@dataclass(frozen=True, eq=False)
class PoolModel:
    """The model so far: what was found."""

    shared: tuple[SharedColumns, ...] = ()
    absorbed: tuple[tuple[int, Place], ...] = ()
    """Number of the session and the hypothesis that is left free there."""

    def with_shared(self, place: Place, since: int = 0) -> "PoolModel":
        return replace(self, shared=(*self.shared, SharedColumns(place, since)))

    def with_absorbed(self, sessions: Iterable[int], place: Place) -> "PoolModel":
        return replace(self, absorbed=(*self.absorbed, *((k, place) for k in sessions)))


@dataclass(frozen=True, eq=False)
class PoolMoments:
    """Hypotheses of width w in a pool, given a model. n sessions, H hypotheses, a amplitudes in the joint fit."""

    U: Array
    """(n, H, w) scores, 1/SI, given the joint fit."""
    evidence: Array
    """(n, H, w) scores as they enter the evidence: those of estimated noise shrunk."""
    F: Array
    """(n, H, w, w) 1/SI²."""
    cross: Array
    """(n, H, w, a) 1/SI²: information shared with the joint fit."""
    lost: Array
    """(H, w, w) 1/SI²: information of the pool that the joint fit takes."""

    @property
    def pooled(self) -> tuple[Array, Array]:
        """(H, w) score and (H, w, w) information of the pool, given the joint fit."""
        return self.U.sum(axis=0), self.F.sum(axis=0) - self.lost


@dataclass(frozen=True, eq=False)
class Pool:
    """A group's sessions added up under a model."""

    layout: GroupLayout
    model: PoolModel
    scale: Array
    """(n,) factor by which the variance of each session exceeds the stated one."""
    moments: dict[int, PoolMoments]
    fit: JointFit
    """Fit of the amplitudes that the model shares."""


def extended(part: Part, scale: float) -> tuple[Array, Array, Among]:
    """(E,) U, (E,) U as it enters the evidence, and F, in 1/SI, of a session with its sums over sensors."""
    s = part.statistics
    U = s.score * s.size / scale
    shrink = np.repeat(s.shrink, [b.width for b in s.blocks])
    if not part.sums:
        return U, U * shrink, lambda rows, columns: s.among(rows, columns) * s.size[rows] * s.size[columns] / scale
    F = s.information * s.size[:, None] * s.size / scale
    add = np.zeros((len(part.sums), len(U)))
    for row, members in zip(add, part.sums, strict=True):
        row[list(members)] = 1.0
    mean = np.concatenate([shrink, [float(shrink[list(m)].mean()) for m in part.sums]])
    across = add @ F
    U, F = np.concatenate([U, add @ U]), np.block([[F, across.T], [across, across @ add.T]])
    return U, U * mean, among(F)


def among(F: Array) -> Among:
    """An information (E, E), 1/SI², that is known as a whole."""
    return lambda rows, columns: np.asarray(F[rows, columns])


def columns_in(part: Part, place: Place) -> Array | None:
    """(w,) columns of a hypothesis in a session; None where the session does not speak of it."""
    width, number = place
    matching = np.flatnonzero(part.hypotheses.get(width, np.zeros(0)) == number)
    return part.columns[width][matching[0]] if len(matching) else None


def without(U: Array, E: Array, information: Among, columns: Sequence[int]) -> tuple[Array, Array, Array]:
    """U (E,), evidence (E,) and F (E, E) given some columns left free."""
    every = range(len(U))
    F = information(*np.ix_(every, every))
    scores, left = given(np.stack([U, E], axis=1), F, columns, LEFT)
    return scores[:, 0], scores[:, 1], left


def pooled(layout: GroupLayout, model: PoolModel = PoolModel(), scale: Array | None = None) -> Pool:
    """All sessions of a layout added up under a model; ``scale`` (n,) of their variances, by default 1."""
    n = len(layout.parts)
    scale = np.ones(n) if scale is None else scale
    a = sum(s.place[0] for s in model.shared)
    empty = {
        w: (np.zeros((n, H, w)), np.zeros((n, H, w)), np.zeros((n, H, w, w)), np.zeros((n, H, w, a)))
        for w, H in ((w, len(table)) for w, table in layout.hypotheses.items())
    }
    fit = JointFit(np.zeros((n, a)), np.zeros((n, a, a)))
    for k, part in enumerate(layout.parts):
        U, E, F = extended(part, float(scale[k]))
        free = [c for j, place in model.absorbed if j == k and (c := columns_in(part, place)) is not None]
        if free:
            U, E, left = without(U, E, F, np.unique(np.concatenate(free)).tolist())
            F = among(left)
        where, joint = joint_columns(part, model, k)
        fit.U[k, where], fit.F[k][np.ix_(where, where)] = U[joint], F(*np.ix_(joint, joint))
        for w, numbers in part.hypotheses.items():
            c = part.columns[w]
            all_U, all_E, all_F, cross = empty[w]
            all_U[k, numbers], all_E[k, numbers] = U[c], E[c]
            all_F[k, numbers] = F(c[:, :, None], c[:, None, :])
            if joint:
                cross[k][numbers[:, None, None], np.arange(w)[None, :, None], np.array(where)[None, None, :]] = F(
                    c[:, :, None], np.array(joint)[None, None, :]
                )
    moments = {}
    for w, (all_U, all_E, all_F, cross) in empty.items():
        explained = fit.explains(cross)
        moments[w] = PoolMoments(all_U - explained, all_E - explained, all_F, cross, fit.absorbs(cross))
    return Pool(layout, model, scale, moments, fit)


def joint_columns(part: Part, model: PoolModel, session: int) -> tuple[list[int], list[int]]:
    """Numbers of the joint fit's amplitudes that act in a session, and their columns there."""
    where: list[int] = []
    joint: list[int] = []
    start = 0
    for s in model.shared:
        width = s.place[0]
        columns = columns_in(part, s.place) if session >= s.since else None
        if columns is not None:
            where += range(start, start + width)
            joint += columns.tolist()
        start += width
    return where, joint
