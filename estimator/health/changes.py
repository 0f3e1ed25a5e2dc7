"""The changes of all sensors of one kind since the reference session, stacked, with what correlates them.

The unit of a change is that of its quantity: rad for axes, relative for scales.
"""

from dataclasses import dataclass

import numpy as np

from estimator.health.deviation import Deviation, deviation
from estimator.results import Calibration, SensorCalibration
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class Changes:
    """The changes of one quantity of m sensors; r rows a sensor, k numbers common to the block."""

    names: tuple[str, ...]
    y: Array
    """(m r,) rad or relative."""
    own: Array
    """(m r, m r) covariance that the session brings, rad² or relative²."""
    origin: Array
    """(m r, m r) covariance that the reference brings, rad² or relative²."""
    design: Array
    """(m r, k) A, dimensionless."""
    scatter: float = 0.0
    """τ, rad or relative."""
    dofs: tuple[tuple[float | None, float | None], ...] = ()
    """Of each sensor the degrees of freedom of both covariances; none where all noise is known."""

    @property
    def rows(self) -> int:
        """r."""
        return len(self.y) // max(len(self.names), 1)

    @property
    def covariance(self) -> Array:
        """(m r, m r) of both sessions, and what sensors do on their own, rad² or relative²."""
        return self.own + self.origin + self.scatter**2 * np.eye(len(self.y))

    def where(self, sensors: list[int]) -> Array:
        """(n r,) places of the rows of n sensors, a number without unit."""
        return (np.array(sensors, dtype=int)[:, None] * self.rows + np.arange(self.rows)).ravel()

    def residuals(self, gain: Array) -> dict[str, Deviation]:
        """What the common part x = gain·y, gain (k, m r) dimensionless, leaves of each sensor."""
        rest = np.eye(len(self.y)) - self.design @ gain
        y, own, origin = rest @ self.y, rest @ self.own @ rest.T, rest @ self.origin @ rest.T
        at = {name: self.where([i]) for i, name in enumerate(self.names)}
        dofs = dict(zip(self.names, self.dofs, strict=False))
        return {n: Deviation(y[w], own[np.ix_(w, w)], origin[np.ix_(w, w)], *dofs.get(n, ())) for n, w in at.items()}


def axis_changes(current: Calibration, reference: Calibration, kind: str) -> Changes | None:
    """Of the axes of one kind of sensor; None where no axis is known in both sessions."""
    known = _known(current, reference, kind, "axis")
    elements = [f"{now.name}.{element}" for now, _, _ in known for element in ("axis_1", "axis_2")]
    own, origin = _joint(current, elements), _joint(reference, elements)
    if own is None or origin is None:
        return None
    turn = np.zeros((2 * len(known), 2 * len(known)))
    for i, (now, then, _) in enumerate(known):
        turn[2 * i : 2 * i + 2, 2 * i : 2 * i + 2] = then.axis_tangents.T @ now.axis_tangents
    design = np.concatenate([np.cross(np.asarray(then.axis), then.axis_tangents.T) for _, then, _ in known])
    y = np.concatenate([d.vector for _, _, d in known])
    names = tuple(now.name for now, _, _ in known)
    return Changes(names, y, turn @ own @ turn.T, origin, design, dofs=_dofs(known))


def scale_changes(current: Calibration, reference: Calibration, kind: str) -> Changes | None:
    """Of the scales of one kind of sensor; None where no scale is known in both sessions."""
    known = _known(current, reference, kind, "scale")
    elements = [f"{now.name}.scale" for now, _, _ in known]
    own, origin = _joint(current, elements), _joint(reference, elements)
    if own is None or origin is None:
        return None
    y = np.array([d.vector[0] for _, _, d in known])
    then = np.array([t.scale.value for _, t, _ in known], dtype=float)
    ratio = (1 + y) / then
    names = tuple(now.name for now, _, _ in known)
    own, origin = own / np.outer(then, then), origin * np.outer(ratio, ratio)
    return Changes(names, y, own, origin, np.ones((len(y), 1)), dofs=_dofs(known))


Known = list[tuple[SensorCalibration, SensorCalibration, Deviation]]
"""Each sensor as it is, as the reference has it, and its change."""


def _dofs(known: Known) -> tuple[tuple[float | None, float | None], ...]:
    """Of each sensor's change the degrees of freedom of both sessions."""
    return tuple((d.own_dof, d.origin_dof) for _, _, d in known)


def _known(current: Calibration, reference: Calibration, kind: str, parameter: str) -> Known:
    """The sensors of a kind that both sessions hold, with a finite change of the parameter."""
    then = {sensor.name: sensor for sensor in reference.sensors if sensor.kind == kind}
    pairs = [(now, then[now.name]) for now in current.sensors if now.kind == kind and now.name in then]
    return [(now, then, d) for now, then in pairs if (d := deviation(now, then, parameter)) and d.is_finite]


def _joint(calibration: Calibration, names: list[str]) -> Array | None:
    """(n, n) total covariance of n elements, products of their SI units; None where not all of them are known."""
    place = {name: i for i, name in enumerate(calibration.names)}
    if not names or not all(name in place for name in names):
        return None
    rows = [place[name] for name in names]
    found = calibration.covariance[np.ix_(rows, rows)]
    return found if np.isfinite(found).all() else None
