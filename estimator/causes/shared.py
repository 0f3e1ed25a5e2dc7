"""A course that nobody recorded and several sensors share: the temperature of a room, a supply that wanders.

It cannot be named on one sensor alone: there a course without a formula is whatever the sensor reads. Of several it is
their one course, with a size each. Its shape is a sum of the leading waves of a random walk, or, where it is smooth, of
an integrated one (of the covariance s²(3t − s)/6, s ≤ t; Rasmussen & Williams 2006, 6.3.1), each as large as the walk
has it.
"""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from estimator.arrays import eigh
from estimator.causes.contract import SensorCause, Setting, column
from estimator.session import Array

WAVES = 12
"""Leading waves of a course that are kept: of a random walk they hold 97 %."""


class SharedCourse(SensorCause):
    """A course of several sensors. Its shape is the sizes of the waves of `KINDS` in turn, zero but for one kind; they
    are found where sensors share them, and tried on no single one.
    """

    identifier = "shared-course"
    scope = "environment"
    equation = "k·h(r), one h for several sensors"
    units = ("m/s²",)
    passing = True
    alike = True
    sentence = "The bias of {sensors} follows a course that no recorded quantity explains."
    advice = "Record the temperature and the supply of the block, and repeat the session."
    shared_sentence = "The biases of {sensors} follow one common course that no recorded quantity explains."
    shared_advice = "They have a common cause: record the temperature and the supply of the block, and repeat."

    def grid(self, setting: Setting) -> Iterator[tuple[float, ...]]:
        yield from ()

    def term(self, setting: Setting, i: int, nonlinear: tuple[float, ...]) -> Array:
        """(R, 1) dimensionless."""
        return column(np.concatenate([waves(setting.rows) for waves in KINDS], axis=1) @ np.array(nonlinear))


@lru_cache(maxsize=8)
def walk(rows: int) -> Array:
    """(R, w) dimensionless: waves of a random walk over the rows, of mean square one together."""
    t = np.arange(1, rows + 1) / rows
    return leading(np.minimum.outer(t, t))


@lru_cache(maxsize=8)
def walking_rate(rows: int) -> Array:
    """(R, w) dimensionless: the same of a zero whose rate walks."""
    t = np.arange(1, rows + 1) / rows
    first, last = np.minimum.outer(t, t), np.maximum.outer(t, t)
    return leading(first**2 * (last / 2 - first / 6))


KINDS = (walk, walking_rate)


def of_kind(kind: int, sizes: Array) -> tuple[float, ...]:
    """The shape of a course that has waves of one of `KINDS` alone, of ``sizes`` (w,)."""
    by_kind = [sizes if k == kind else np.zeros_like(sizes) for k in range(len(KINDS))]
    return tuple(np.concatenate(by_kind).tolist())


def kind_of(shape: tuple[float, ...]) -> int:
    """Index in `KINDS` of the waves of a course."""
    return int(np.argmax([np.any(sizes) for sizes in np.split(np.array(shape), len(KINDS))]))


def leading(covariance: Array) -> Array:
    """(R, w) dimensionless: the strongest waves of a covariance (R, R) about its mean, all beginning below it."""
    about = covariance - covariance.mean(axis=0) - covariance.mean(axis=1)[:, None] + covariance.mean()
    size, wave = eigh(about * len(about) / np.trace(about))
    return np.asarray(wave[:, -WAVES:] * -np.sign(wave[0, -WAVES:]) * np.sqrt(np.maximum(size[-WAVES:], 0.0)))
