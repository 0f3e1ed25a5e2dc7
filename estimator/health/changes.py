"""The changes of all sensors of one kind since the reference session, stacked, with what correlates them.

The unit of a change is that of its quantity: rad for axes, relative for scales. Axes are compared with those of the
reference turned by a rotation of the block, exactly: what is left is small whatever the turn, and only that is linear.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from estimator.coverage import combined
from estimator.health.deviation import Deviation, axis_offset, deviation
from estimator.results import Calibration, SensorCalibration
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class Changes:
    """The changes of one quantity of m sensors; r rows a sensor, k numbers common to the block."""

    names: tuple[str, ...]
    y: Array
    """(m r,) rad or relative."""
    current: Array
    """(m r, m r) covariance that the session brings, rad² or relative²."""
    origin: Array
    """(m r, m r) covariance that the reference brings, rad² or relative²."""
    design: Array
    """(m r, k) A, dimensionless."""
    scatter: float = 0.0
    """τ, rad or relative."""
    dofs: tuple[tuple[float | None, float | None], ...] = ()
    """Degrees of freedom of both covariances, sensor by sensor; empty where all noise is known."""

    @cached_property
    def rows(self) -> int:
        """r."""
        return len(self.y) // max(len(self.names), 1)

    @cached_property
    def covariance(self) -> Array:
        """(m r, m r) covariance of the changes: both sessions and the scatter of single sensors, rad² or relative²."""
        return self.current + self.origin + self.scatter**2 * np.eye(len(self.y))

    @cached_property
    def dof(self) -> float | None:
        """Effective degrees of freedom that the least known sensor's noise is known to; None when all is known."""
        current, origin = np.diagonal(self.current), np.diagonal(self.origin)
        dofs = []
        for i, (now, before) in enumerate(self.dofs):
            if now is None and before is None:
                continue
            at, known = self.where([i]), (self.rows * self.scatter**2, None)
            dofs.append(combined((float(current[at].sum()), now), (float(origin[at].sum()), before), known))
        return min((dof for dof in dofs if dof is not None), default=None)

    def where(self, sensors: Sequence[int] | Sequence[Sequence[int]]) -> Array:
        """(..., n r) places of the rows of n sensors each, a number without unit."""
        numbers = np.array(sensors, dtype=int)
        places = numbers[..., None] * self.rows + np.arange(self.rows)
        return places.reshape(*numbers.shape[:-1], -1)


@dataclass(frozen=True, eq=False)
class AxisPairs:
    """The axes of m sensors of one kind in both sessions, with their joint covariances."""

    names: tuple[str, ...]
    axes: Array
    """(m, 3) axes in this session, unit vectors."""
    frames: Array
    """(m, 3, 2) tangents that its covariance turns them along, dimensionless."""
    origins: Array
    """(m, 3) axes in the reference, unit vectors."""
    origin_frames: Array
    """(m, 3, 2)"""
    current: Array
    """(2 m, 2 m) rad²."""
    origin: Array
    """(2 m, 2 m) rad²."""
    dofs: tuple[tuple[float | None, float | None], ...]
    """Degrees of freedom of both covariances, sensor by sensor; None where the noise is known."""

    def about(self, turn: Array) -> Changes:
        """The changes that a rotation ``turn`` (3, 3) of the block, dimensionless, leaves: along the reference's
        tangents, turned with it."""
        expected, frames = self.origins @ turn.T, turn @ self.origin_frames
        bases = np.swapaxes(frames, -1, -2) @ self.frames
        m = len(self.names)
        carried = np.zeros((2 * m, 2 * m))
        for i, basis in enumerate(bases):
            carried[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = basis
        y = [axis_offset(*pair) for pair in zip(self.axes, expected, frames, strict=True)]
        design = np.cross(expected[:, None, :], np.swapaxes(frames, -1, -2)).reshape(2 * m, 3)
        return Changes(
            self.names, np.concatenate(y), carried @ self.current @ carried.T, self.origin, design, dofs=self.dofs
        )


def axis_pairs(current: Calibration, reference: Calibration, kind: str) -> AxisPairs | None:
    """The axes of one kind of sensor; None where no axis is known in both sessions."""
    known = _known(current, reference, kind, "axis")
    elements = [f"{now.name}.{element}" for now, _, _ in known for element in ("axis_1", "axis_2")]
    covariance, origin = _joint(current, elements), _joint(reference, elements)
    if covariance is None or origin is None:
        return None
    return AxisPairs(
        names=tuple(now.name for now, _, _ in known),
        axes=np.array([now.axis for now, _, _ in known]),
        frames=np.stack([now.axis_tangents for now, _, _ in known]),
        origins=np.array([before.axis for _, before, _ in known]),
        origin_frames=np.stack([before.axis_tangents for _, before, _ in known]),
        current=covariance,
        origin=origin,
        dofs=_dofs(known),
    )


def scale_changes(current: Calibration, reference: Calibration, kind: str) -> Changes | None:
    """The scale changes of one kind of sensor; None where no scale is known in both sessions."""
    known = _known(current, reference, kind, "scale")
    elements = [f"{now.name}.scale" for now, _, _ in known]
    covariance, origin = _joint(current, elements), _joint(reference, elements)
    if covariance is None or origin is None:
        return None
    y = np.array([d.vector[0] for _, _, d in known])
    scales = np.array([t.scale.value for _, t, _ in known], dtype=float)
    ratio = (1 + y) / scales
    names = tuple(now.name for now, _, _ in known)
    covariance, origin = covariance / np.outer(scales, scales), origin * np.outer(ratio, ratio)
    return Changes(names, y, covariance, origin, np.ones((len(y), 1)), dofs=_dofs(known))


Known = list[tuple[SensorCalibration, SensorCalibration, Deviation]]
"""Each sensor as it is, as the reference has it, and its change."""


def _dofs(known: Known) -> tuple[tuple[float | None, float | None], ...]:
    """Degrees of freedom of this session and of the reference, for each sensor's change."""
    return tuple((d.current_dof, d.origin_dof) for _, _, d in known)


def _known(current: Calibration, reference: Calibration, kind: str, parameter: str) -> Known:
    """The sensors of a kind that both sessions hold, with a finite change of the parameter."""
    by_name = {sensor.name: sensor for sensor in reference.sensors if sensor.kind == kind}
    pairs = [(now, by_name[now.name]) for now in current.sensors if now.kind == kind and now.name in by_name]
    return [(now, before, d) for now, before in pairs if (d := deviation(now, before, parameter)) and d.is_finite]


def _joint(calibration: Calibration, names: list[str]) -> Array | None:
    """(n, n) total covariance of n elements, products of their SI units; None where not all of them are known."""
    place = {name: i for i, name in enumerate(calibration.names)}
    if not names or not all(name in place for name in names):
        return None
    rows = [place[name] for name in names]
    covariance = calibration.covariance[np.ix_(rows, rows)]
    return covariance if np.isfinite(covariance).all() else None
