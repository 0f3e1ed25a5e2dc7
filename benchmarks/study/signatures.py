"""All signatures of the catalogue in a session's residuals, for rivals that look through them one by one.

With a history each is tried as new and as lasting since before it, where it can be either.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.causes.contract import SensorCause, Shape, Signature
from estimator.diagnosis.posterior.absorbed import absorbed_before
from estimator.diagnosis.posterior.explained import ExplainedSession, Scored
from estimator.diagnosis.posterior.term import Place
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.session import Array
from estimator.significance import equivalent_chi2, p_value

FAINT = 0.02
"""Share of the strongest direction's trace above which a direction counts as an amplitude of its own."""


@dataclass(frozen=True, eq=False)
class Traces:
    """The shapes of one cause, all lasting or all new. S shapes, n rows, q amplitudes."""

    cause: Signature
    shapes: tuple[Shape, ...]
    lasting: bool
    columns: Array
    """(S, n, q) standard errors per unit amplitude; zero where the baseline absorbs one."""


@dataclass(frozen=True, eq=False)
class Signatures:
    """The signatures that a session may hold. K shapes of all causes."""

    residuals: WhitenedResiduals
    each: tuple[Traces, ...]

    @classmethod
    def of(cls, state: ExplainedSession) -> "Signatures":
        """Those of the session's catalogue."""
        catalogue = [c for c in state.catalogue if isinstance(c, Signature)]
        return cls(state.residuals, tuple(traces_of(state.residuals, catalogue)))

    @property
    def library(self) -> Array:
        """(n, Σq) all columns, shape by shape."""
        return np.concatenate([t.columns.swapaxes(0, 1).reshape(len(self.residuals.z), -1) for t in self.each], axis=1)

    @cached_property
    def places(self) -> dict[str, int]:
        """Number of visible shapes of each cause."""
        counted: dict[str, int] = {}
        for t in self.each:
            seen = int(np.any(t.columns, axis=(1, 2)).sum())
            counted[t.cause.identifier] = counted.get(t.cause.identifier, 0) + max(seen, 1)
        return counted

    @property
    def families(self) -> int:
        """Number of causes that are put to the test, noise among them."""
        return len(self.places) + 1

    def scores(self, attributed: Array) -> "SignatureScores":
        """All shapes beside findings, ``attributed`` (n, f) their orthonormal traces."""
        z = self.residuals.z - attributed @ (attributed.T @ self.residuals.z)
        each = [explained(t.columns, z, attributed) for t in self.each]
        power, q = (np.concatenate([np.zeros(0), *parts]) for parts in zip(*each, strict=True))
        if self.residuals.baseline.unstated.any():
            energy = np.maximum(z @ z - power, 0.0)
            power = equivalent_chi2(power, q, energy, self.residuals.freedom - attributed.shape[1] - q)
        return SignatureScores(self.each, power, q)


@dataclass(frozen=True, eq=False)
class SignatureScores:
    """The shapes with what each explains by itself. K shapes."""

    each: tuple[Traces, ...]
    statistic: Array
    """(K,) χ²."""
    freedom: Array
    """(K,) its degrees of freedom."""

    @cached_property
    def p_value(self) -> Array:
        """(K,)"""
        return p_value(self.statistic, self.freedom)

    @cached_property
    def cause(self) -> Array:
        """(K,) str, the cause of every shape."""
        return np.array([t.cause.identifier for t in self.each for _ in t.shapes], dtype=object)

    @cached_property
    def _numbers(self) -> list[tuple[Traces, int]]:
        return [(t, s) for t in self.each for s in range(len(t.shapes))]

    def group(self, k: int) -> Place:
        """The cause of a shape and its sensors."""
        t, s = self._numbers[k]
        return t.cause.identifier, t.shapes[s].sensors

    def scored(self, k: int) -> Scored:
        """One shape."""
        t, s = self._numbers[k]
        return Scored(t.cause, t.shapes[s], t.lasting, t.columns[s], float(self.statistic[k]), float(self.p_value[k]))


def traces_of(residuals: WhitenedResiduals, catalogue: Sequence[Signature]) -> Iterator[Traces]:
    """The traces of every cause that the session can show."""
    setting = residuals.baseline.setting
    for cause in catalogue:
        if not cause.available(setting) or (cause.between and residuals.change is None):
            continue
        shapes = tuple(cause.shapes(setting))
        if not shapes:
            continue
        white = residuals.whitened(np.concatenate([s.columns for s in shapes], axis=-1))
        if residuals.change is not None and not cause.between:
            before = absorbed_before(residuals, cause, shapes) if isinstance(cause, SensorCause) else None
            yield Traces(cause, shapes, True, seen(residuals.remaining_of(white, before), white, len(shapes)))
        yield Traces(cause, shapes, False, seen(residuals.remaining_of(white, 0.0), white, len(shapes)))


def seen(trace: Array, white: Array, count: int) -> Array:
    """(S, n, q) traces (n, S·q) of signatures ``white`` (N, S·q) before the baseline absorbs its share; zero where it
    absorbs as good as all."""
    visible = np.linalg.norm(trace, axis=0) > INVISIBLE * np.linalg.norm(white, axis=0)
    return np.asarray((trace * visible).reshape(len(trace), count, -1).swapaxes(0, 1))


def explained(columns: Array, z: Array, attributed: Array) -> tuple[Array, Array]:
    """(S,) χ² that traces (S, n, q) explain of residuals z (n,), and (S,) number of their directions, beside
    ``attributed`` (n, f)."""
    size = np.linalg.norm(columns, axis=1, keepdims=True)
    unit = columns / np.where(size > 0, size, 1.0)
    unit = unit - attributed @ (attributed.T @ unit)
    directions, length, _ = np.linalg.svd(unit, full_matrices=False)
    live = (length > FAINT * length[:, :1]) & (length > FAINT)
    return ((z @ directions) ** 2 * live).sum(axis=1), live.sum(axis=1).astype(float)
