"""Traces of signatures in the residuals: those of a cause's shapes, and one shape with its score."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.contract import Setting, Shape, Signature
from estimator.diagnosis.signatures.products import Nuisance, Products
from estimator.session import Array

INVISIBLE = 1e-3
"""Share of a signature that the baseline must leave for it to be visible: below it the effect would have to be a
thousand times what is seen of it, beyond what the linearised model describes."""

Group = tuple[str, tuple[int, ...]]
"""A cause and the numbers of its sensors: the thing that is named."""


def sensors_of(shapes: Sequence[Shape]) -> Array:
    """(S,) int, the number of the sensor that each shape is blamed on; −1 for none."""
    return np.array([next(iter(s.sensors), -1) for s in shapes], dtype=int)


@dataclass(frozen=True, eq=False)
class Traces:
    """The traces of all shapes of one cause. S shapes, n rows, q amplitudes."""

    cause: Signature
    shapes: tuple[Shape, ...]
    lasting: tuple[bool, ...]
    """(S,) whether each is taken as having acted since before the history."""
    sensor: Array
    """(S,) int, the number of the sensor that each is blamed on; −1 for none."""
    columns: Array
    """(S, n, q) standard errors per unit amplitude."""
    raw: Array
    """(S, width) norm of every column before the baseline absorbed its share, standard errors; 0 where a column is no
    amplitude of the cause but a parameter change left open."""
    places: int
    """Number of shapes that are visible at all: what the cause's prior is shared among."""
    products: Products
    """Products of the columns, those beside them included, with one another and with the residuals."""
    nuisance: Nuisance | None = None
    """Columns that are no amplitudes of the cause, but left open; None where there are none."""
    shared: bool = False
    """Whether they belong to a course that several sensors show: all of them together show that it acts in the
    session.
    """

    @property
    def common(self) -> bool:
        """Whether they act on no sensor in particular."""
        return not self.shapes[0].sensors

    @property
    def width(self) -> int:
        """Number of amplitudes, and of columns beside them."""
        return self.columns.shape[-1] + (0 if self.nuisance is None else self.nuisance.width)

    def whole(self, k: int) -> tuple[Shape, Array]:
        """One shape and its trace (n, width), standard errors per unit; what is beside acts on no reading."""
        shape, columns = self.shapes[k], self.columns[k]
        if self.nuisance is None:
            return shape, columns
        rows = np.zeros((len(columns), self.nuisance.width))
        rows[len(columns) - self.nuisance.rows :] = self.nuisance.columns[self.nuisance.number[k]]
        silent = np.zeros((*shape.columns.shape[:2], self.nuisance.width))
        wide = replace(shape, columns=np.concatenate([shape.columns, silent], axis=-1))
        return wide, np.concatenate([columns, rows], axis=1)

    def at(self, sensors: tuple[int, ...]) -> "Traces":
        """The shapes on a sensor, and those of no sensor; the prior is still shared among all."""
        return self.chosen(np.flatnonzero(np.isin(self.sensor, [-1, *sensors])).tolist())

    def chosen(self, numbers: Sequence[int]) -> "Traces":
        """Some of the shapes, by number; the prior is still shared among all."""
        shapes, lasting = tuple(self.shapes[k] for k in numbers), tuple(self.lasting[k] for k in numbers)
        columns, products = self.columns.swapaxes(0, 1)[:, numbers].swapaxes(0, 1), self.products.at(numbers)
        nuisance = None if self.nuisance is None else self.nuisance.at(numbers)
        sensor, raw = self.sensor[numbers], self.raw[numbers]
        return Traces(self.cause, shapes, lasting, sensor, columns, raw, self.places, products, nuisance)


@dataclass(frozen=True, eq=False)
class Scored:
    """One shape with its score given other findings. n rows, q amplitudes."""

    cause: Signature
    shape: Shape
    lasting: bool
    trace: Array
    """(n, q) standard errors per unit amplitude."""
    statistic: float
    """Equivalent χ²."""
    freedom: int
    """Degrees of freedom of the statistic."""
    log_evidence: float
    """ln Bayes factor, the share of the cause's prior included."""
    p_value: float
    """p-value of this shape alone."""
    places: int
    """Number of shapes the cause was tried with."""
    shared: bool = False
    """`Traces.shared` of its traces."""

    @property
    def sensors(self) -> tuple[int, ...]:
        """The sensors it is attributed to; none for a cause of stand, fixture or record."""
        return self.shape.sensors

    @property
    def group(self) -> Group:
        """The cause and its sensors."""
        return self.cause.identifier, self.sensors

    @property
    def strength(self) -> float:
        """Strength in standard errors."""
        return float(np.sqrt(self.statistic))

    def columns_in(self, setting: Setting) -> Array | None:
        """(R, m, q) m/s² (rad/s) per unit amplitude: the same effect in another session; None where it cannot show."""
        return self.cause.columns(setting, self.shape) if self.cause.available(setting) else None
