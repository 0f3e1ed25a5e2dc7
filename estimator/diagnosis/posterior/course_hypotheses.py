"""Families of unknown courses of the applied vector.

The course of a change δn over a session is a Gaussian process in up to three components (turns along β and α, relative
size): smooth along the order measured, smooth along β in all runs alike or run by run, anew at every row, or a change
that stays.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import Setting
from estimator.diagnosis.posterior.kernels import FAINT, LENGTHS, ROUND, around, bending
from estimator.message import say
from estimator.session import ACCELEROMETER, Array

SIZE = "size"
"""The component that no turn of the applied vector makes."""


@dataclass(frozen=True, eq=False)
class Component:
    """One way in which the applied vector may change."""

    words: str
    columns: Array
    """(R, m) input change, m/s² (rad/s) per rad or per unit."""


@dataclass(frozen=True, eq=False)
class CourseHypothesis:
    """One family of courses: a Gaussian process of r independent unit coefficients, of unknown size."""

    order: str
    components: tuple[str, ...]
    columns: Array
    """(R, m, r) input change, m/s² (rad/s) per unit of each coefficient."""
    lift: Array
    """(c, R, r) the course of each component per unit of each coefficient, rad or relative."""


def components(setting: Setting) -> list[Component]:
    """The components of a change of the applied vector that the session may show."""
    size = setting.through(setting.n[..., None])[..., 0]
    gyro = np.array([kind != ACCELEROMETER for kind in setting.kinds])
    if setting.d_beta is None or setting.d_alpha is None:
        return [Component(SIZE, size * ~gyro)]
    turns = [setting.through(d[..., None])[..., 0] for d in (setting.d_beta, setting.d_alpha)]
    directions = [Component("β", turns[0]), Component("α", turns[1]), Component(SIZE, size)]
    if gyro.any() and not gyro.all():
        directions += [Component("β of the gyros", turns[0] * gyro), Component("α of the gyros", turns[1] * gyro)]
    return directions


def together(count: int) -> list[list[int]]:
    """The sets of components, by index, that may change at once."""
    usual = [[0]] if count == 1 else [[0], [1], [0, 1], [0, 1, 2]]
    return usual + ([[3], [4], [3, 4]] if count > 3 else [])


def kernels(setting: Setting) -> Iterator[tuple[str, Array]]:
    """Orders along which a course may run, each with the covariance (R, R), dimensionless, of a unit course."""
    place = np.arange(setting.rows) / max(setting.rows - 1, 1)
    yield "the order measured", np.minimum(place[:, None], place) + 1 / setting.rows
    for length in LENGTHS:
        yield "the order measured", bending(place, length)
    yield "no order: independent in every row", np.eye(setting.rows)
    if setting.beta is None or setting.flipped is None:
        return
    same_run = setting.flipped[:, None] == setting.flipped
    for length in ROUND:
        kernel = around(setting.beta, length)
        yield "β", kernel
        if not same_run.all():
            yield "β, each run separately", kernel * same_run


def hypotheses(setting: Setting) -> Iterator[CourseHypothesis]:
    """Every family of courses: components along orders, and changes that stay through a session or a run."""
    parts = components(setting)
    for order, kernel in kernels(setting):
        root = covariance_root(kernel)
        for chosen in together(len(parts)):
            columns = np.concatenate([parts[k].columns[..., None] * root[:, None, :] for k in chosen], axis=-1)
            lift = np.kron(np.eye(len(chosen)), root).reshape(len(chosen), setting.rows, -1)
            yield CourseHypothesis(order, tuple(parts[k].words for k in chosen), columns, lift)
    for order, columns in changes(setting):
        yield CourseHypothesis(order, (), columns, np.zeros((0, setting.rows, columns.shape[-1])))


def changes(setting: Setting) -> Iterator[tuple[str, Array]]:
    """Changes of the applied vector n → n + M·n that stay through a session or a run: (R, m, q), m/s² (rad/s) per unit
    of each element of M, that of a turn or any."""
    if setting.beta is None or setting.flipped is None:
        return
    element = np.eye(9).reshape(9, 3, 3)
    whole = setting.through(np.einsum("qij,rmj->rmiq", element, setting.n))
    turn = whole[..., [7, 2, 3]] - whole[..., [5, 6, 1]]
    flipped = setting.flipped[:, None, None]
    for words, fixed in (("turned as a whole", turn), ("changed as a whole", whole)):
        yield words, fixed
        if 0 < setting.flipped.sum() < setting.rows:
            yield (
                say("{words}, each run separately", words=words),
                np.concatenate([fixed * flipped, fixed * ~flipped], axis=-1),
            )


def covariance_root(kernel: Array) -> Array:
    """L (R, r) with LL' a covariance (R, R), dimensionless, directions of no size left out."""
    size, turn = eigh(kernel)
    positive = size > FAINT * size[-1]
    return np.asarray(turn[:, positive] * np.sqrt(size[positive]))
