"""Causes of the catalogue on one sensor: all shapes of a sensor touch the block of its own readings."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.causes.contract import SensorCause, Shape, Signature
from estimator.diagnosis.posterior.absorbed import absorbed_before
from estimator.diagnosis.posterior.information import InputInformation
from estimator.diagnosis.posterior.layout import InputLayout
from estimator.diagnosis.posterior.priors import EACH_CAUSE, IN_PART, ONE_WITHIN, SIZES
from estimator.diagnosis.posterior.term import CauseEffect, ListedTerms, Since, Term
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array

SINCE = {Since.BEFORE: (1 - IN_PART) / 2, Since.NOW: (1 - IN_PART) / 2, Since.OPEN: IN_PART}
"""Shares of a cause's prior by since when it acts, where there is a history."""


@dataclass(frozen=True, eq=False)
class SensorShapes:
    """Shapes of one cause on one sensor under one assumption about the history. S shapes, q amplitudes."""

    cause: SensorCause
    sensor: int
    since: Since
    nonlinear: tuple[tuple[float, ...], ...]
    rows: Array
    """(S, R + P, q) per unit of size: on the sensor's readings and, of what the history absorbed, on the parameters."""
    scale: Array
    """(S, q') amplitude, in the cause's SI unit, of a unit of size; of its own columns."""
    log_prior: float
    """ln prior odds of one shape, all its sizes together."""
    open_by: Array
    """(S,) standard deviation of an amplitude that must be one."""


@dataclass(frozen=True, eq=False)
class ShapeBlock:
    """All shapes of one width on one sensor. S shapes."""

    sensor: int
    parts: tuple[SensorShapes, ...]
    index: Array
    """(R + P,) the rows of D that the sensor's terms touch."""
    rows: Array
    """(S, R + P, q)."""
    log_prior: Array
    """(S, 1) ln prior odds of a shape at one size."""
    sizes: Array
    """(L,) m/s² (rad/s)."""
    fixed: Array
    """(S,) amplitude that the cause must have, in units of size; 0 where it is free."""
    within: Array
    """(S,) standard deviation of that amplitude, in units of size."""


class SensorCauses(ListedTerms):
    """All causes of single sensors that a session can show."""

    def __init__(self, residuals: WhitenedResiduals, catalogue: Sequence[Signature]) -> None:
        self.residuals = residuals
        self.layout, setting = InputLayout.of(residuals), residuals.baseline.setting
        causes = [c for c in catalogue if isinstance(c, SensorCause) and c.available(setting)]
        parts = [p for c in causes if self.layout.P or not c.between for p in self.of_cause(c)]
        by_width: dict[tuple[int, int], list[SensorShapes]] = {}
        for part in parts:
            by_width.setdefault((part.sensor, part.rows.shape[2]), []).append(part)
        self.blocks = tuple(self.block(i, members) for (i, _), members in by_width.items())
        self.parts = [(b, p) for b in self.blocks for p in b.parts]
        super().__init__(
            [(p.cause.identifier, (p.sensor,)) for _, p in self.parts],
            [len(p.nonlinear) * len(SIZES) for _, p in self.parts],
        )

    def block(self, i: int, parts: Sequence[SensorShapes]) -> ShapeBlock:
        """The shapes of one width on sensor i."""
        prior = np.concatenate([np.full(len(p.nonlinear), p.log_prior) for p in parts]) - np.log(len(SIZES))
        fixed = np.concatenate([1 / p.scale[:, 0] if p.cause.bounded else np.zeros(len(p.scale)) for p in parts])
        sizes = SIZES * self.layout.unit[i]
        rows = np.concatenate([p.rows for p in parts])
        open_by = np.concatenate([p.open_by if p.cause.bounded else np.zeros(len(p.scale)) for p in parts])
        return ShapeBlock(
            i, tuple(parts), self.layout.of_sensor(i), rows, prior[:, None], sizes, fixed, open_by * fixed
        )

    def of_cause(self, cause: SensorCause) -> Iterator[SensorShapes]:
        """The shapes of a cause on every sensor, under every assumption about the history."""
        setting = self.residuals.baseline.setting
        grids = [(i, list(cause.grid_of(setting, i))) for i, k in enumerate(setting.kinds) if cause.kind in (None, k)]
        found = []
        for i, grid, terms in cause.each(setting, ((i, grid) for i, grid in grids if grid)):
            largest = np.abs(terms).max(axis=1)
            acts = np.flatnonzero((largest > 0).any(axis=-1))
            scale = 1 / np.where(largest > 0, largest, 1.0)
            if len(acts):
                found.append((i, [grid[k] for k in acts], terms[acts] * scale[acts][:, None, :], scale[acts]))
        places = sum(len(grid) for _, grid, _, _ in found)
        assumed = {Since.NOW: 1.0} if self.layout.P == 0 or cause.between else SINCE
        for i, grid, terms, scale in found:
            for since, share in assumed.items():
                prior = float(np.log(EACH_CAUSE / places * share))
                rows = self.placed(cause, i, since, grid, terms, scale)
                yield SensorShapes(cause, i, since, tuple(grid), rows, scale, prior, open_by(terms))

    def placed(
        self, cause: SensorCause, i: int, since: Since, grid: Sequence[tuple[float, ...]], terms: Array, scale: Array
    ) -> Array:
        """(S, R + P, q) ``terms`` (S, R, q) of sensor i at points of a grid, each taken by ``scale`` (S, q) already,
        with what the history absorbed of them and, where the sensor's change is left open, five columns beside."""
        R, P = self.layout.R, self.layout.P
        rows = np.concatenate([terms, np.zeros((len(terms), P, terms.shape[2]))], axis=1)
        if since is Since.BEFORE:
            rows[:, R:] = self.absorbed(cause, i, grid, terms, scale)
        if since is not Since.OPEN:
            return rows
        change = np.zeros((len(terms), R + P, 5))
        change[:, R + 5 * i + np.arange(5), np.arange(5)] = 1 / self.layout.norm[i]
        return np.concatenate([rows, change], axis=2)

    def absorbed(
        self, cause: SensorCause, i: int, grid: Sequence[tuple[float, ...]], terms: Array, scale: Array
    ) -> Array:
        """(S, P, q) what the history absorbed of ``terms`` (S, R, q); where that is not known, as much as now."""
        before = absorbed_before(self.residuals, cause, [Shape((i,), np.zeros(0), g) for g in grid])
        if before is not None:
            return np.asarray(before.reshape(self.layout.P, len(grid), -1).swapaxes(0, 1) * scale[:, None, :])
        S, R, q = terms.shape
        columns = np.zeros((R, self.layout.m, S * q))
        columns[:, i] = terms.swapaxes(0, 1).reshape(R, S * q)
        moved = self.residuals.response @ self.residuals.whitened(columns)
        return np.asarray(moved.reshape(self.layout.P, S, q).swapaxes(0, 1))

    def columns_at(self, effect: CauseEffect, i: int, nonlinear: tuple[float, ...], scale: Array) -> Array:
        """(D, q) an effect on sensor i at a shape that may lie between the points of the grid, per unit of size.

        ``scale`` (q',) as in `Effect`, of this sensor."""
        cause = effect.cause
        assert isinstance(cause, SensorCause)
        terms = cause.terms(self.residuals.baseline.setting, i, [nonlinear]) * scale
        columns = np.zeros((self.layout.D, terms.shape[2] + 5 * (effect.since is Since.OPEN)))
        columns[self.layout.of_sensor(i)] = self.placed(cause, i, effect.since, [nonlinear], terms, scale[None])[0]
        return columns

    def weighed(self, info: InputInformation) -> Array:
        return np.concatenate([self.of_block(info, block).ravel() for block in self.blocks])

    def of_block(self, info: InputInformation, block: ShapeBlock) -> Array:
        """(S, L) ln posterior odds."""
        A, a = info.A[np.ix_(block.index, block.index)], info.a[block.index]
        rows = block.rows
        if rows.shape[2] == 1:
            X = rows[:, :, 0]
            gram, along = ((X @ A) * X).sum(axis=1)[:, None, None], (X @ a)[:, None]
        else:
            gram, along = rows.swapaxes(1, 2) @ (A @ rows), (a @ rows)
        value = info.log_evidence_of(gram, along, block.sizes)
        bounded = block.fixed != 0
        if bounded.any():
            one, within = block.fixed[bounded], block.within[bounded]
            d, b = gram[bounded, 0, 0], along[bounded, 0]
            gap, explained = (b - d * one) * within, 2 * b * one - d * one**2
            about = info.log_evidence_of((d * within**2)[:, None, None], gap[:, None], np.ones(1), explained)
            value[bounded] = -np.inf
            value[bounded, 0] = about[:, 0] + np.log(len(SIZES))
        return np.asarray(value + block.log_prior)

    def term(self, k: int) -> Term:
        group, within = self.located(k)
        (block, part), (s, level) = self.parts[group], divmod(within, len(SIZES))
        columns = np.zeros((self.layout.D, part.rows.shape[2]))
        columns[block.index] = part.rows[s]
        variance, mean = np.full(columns.shape[1], block.sizes[level] ** 2), None
        if part.cause.bounded:
            one = np.zeros(columns.shape[1])
            one[0] = 1 / part.scale[s, 0]
            variance, mean = np.where(one != 0, (part.open_by[s] * one) ** 2, one[0] ** 2), one
        prior = part.log_prior - (0.0 if part.cause.bounded else float(np.log(len(SIZES))))
        effect = CauseEffect(part.cause, part.nonlinear[s], part.since, part.scale[s])
        return Term((part.cause.identifier, (part.sensor,)), columns, variance, prior, True, mean, effect)


def open_by(terms: Array) -> Array:
    """(S,) standard deviation of an amplitude that must be one, of ``terms`` (S, R, q): the limit of clipped readings
    lies anywhere below the lowest of them, which matters the less the deeper the others are cut."""
    cut = np.abs(terms[:, :, 0])
    lowest, count = np.where(cut > 0, cut, np.inf).min(axis=1), (cut > 0).sum(axis=1)
    return np.asarray(ONE_WITHIN * np.where(count > 0, lowest, 0.0) * count / np.maximum(cut.sum(axis=1), 1e-300))
