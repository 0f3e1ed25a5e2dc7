"""An unknown course of the applied vector: an error of stand, fixture or reference that no cause describes.

Theory
------
Every sensor sees a change δn of the applied vector through its axis, e·δn. The course of δn over a session is a
Gaussian process in up to three components (turns along β and α, relative size), each of covariance λ·K over the
rows: smooth along the order measured, smooth along β in all runs alike or run by run, or anew at every row. With T the
trace of the columns of L, K = LL', and T'T = U·diag(d)·U', v = U'T'z, the Bayes factor against noise of known variance
is

    ln B = −½ Σ ln(1 + λd) + ½ Σ v² λ/(1 + λd)                      (Rasmussen & Williams 2006, (2.30))

It is the mean over components, kernels and λ. No sensor's own fault hides there: half its energy lies in parity space.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import Setting
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.autocorrelation import LENGTHS, around, bending
from estimator.diagnosis.signatures.noise import normal_deviate
from estimator.diagnosis.signatures.wandering import log_mean
from estimator.message import say
from estimator.session import ACCELEROMETER, Array

ROUND = (0.4, 1.0, 2.5)
"""Length, rad, over which a course in β keeps its value: some six harmonics, two, or little more than the first."""

LEAST_ENERGY, STEPS = 0.1, 14
"""λ runs from a course hardly visible to one that holds all the energy there is, in so many steps."""

FAINT = 1e-4
"""Share of a kernel's largest direction below which one counts as none."""

SIZE = "size"
"""The component that no turn of the applied vector makes."""


@dataclass(frozen=True, eq=False)
class AppliedCourse:
    """The course that explains most, and the evidence of all. R rows, c components."""

    log_evidence: float
    """ln Bayes factor against no course, the mean over all that were tried."""
    order: str
    """Order of the rows along which it runs."""
    components: tuple[str, ...]
    """Components of the applied vector that change, in words."""
    value: Array
    """(R, c) most likely course: turns in rad, relative size dimensionless."""

    @property
    def p_value(self) -> float:
        """Chance of as much evidence without any course: no more than 1/B (Markov)."""
        return float(min(1.0, np.exp(-self.log_evidence)))

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, with the same evidence."""
        return normal_deviate(self.log_evidence)


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


def applied_course(residuals: WhitenedResiduals, attributed: Array, *, lasting: bool) -> AppliedCourse:
    """The course of the applied vector that explains most of the residuals.

    ``attributed`` (n, f) orthonormal traces of findings, dimensionless, which are projected out; ``lasting``: whether
    the history's sessions had the same course. The noise is taken as it is in the residuals.
    """
    z = residuals.z - attributed @ (attributed.T @ residuals.z)
    tried, leading = [], None
    for hypothesis in hypotheses(residuals.baseline.setting):
        trace = residuals.trace(hypothesis.columns, None if lasting else 0.0)
        trace = trace - attributed @ (attributed.T @ trace)
        log_evidence, coefficients = evidence(trace, z)
        if leading is None or log_evidence > max(tried):
            leading = hypothesis, coefficients
        tried.append(log_evidence)
    assert leading is not None
    likeliest, coefficients = leading
    return AppliedCourse(
        log_evidence=log_mean(tried),
        order=likeliest.order,
        components=likeliest.components,
        value=(likeliest.lift @ coefficients).T,
    )


def covariance_root(kernel: Array) -> Array:
    """L (R, r) with LL' a covariance (R, R), dimensionless, directions of no size left out."""
    size, turn = eigh(kernel)
    positive = size > FAINT * size[-1]
    return np.asarray(turn[:, positive] * np.sqrt(size[positive]))


def evidence(trace: Array, z: Array) -> tuple[float, Array]:
    """ln B of one family of courses, the mean over their size, and the coefficients (r,) of the most likely course.

    ``trace`` (n, r) of its unit coefficients and residuals ``z`` (n,), standard errors.
    """
    size, turn = eigh(trace.T @ trace)
    size, power = np.maximum(size, 0.0), turn.T @ (trace.T @ z)
    strengths = np.geomspace(LEAST_ENERGY, max(float(z @ z), 10.0), STEPS) / max(float(size.sum()), 1e-300)
    shrunk = strengths[:, None] / (1 + strengths[:, None] * size)
    volume = -0.5 * np.log1p(strengths[:, None] * size).sum(axis=1)
    values = volume + 0.5 * (power**2 * shrunk).sum(axis=1)
    value = turn @ (power * shrunk[int(np.argmax(values))])
    return log_mean(values), value
