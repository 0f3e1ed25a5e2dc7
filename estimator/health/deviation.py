"""Deviation of one parameter from the reference session, with the uncertainty of both. Units: see the package page."""

from dataclasses import dataclass, replace

import numpy as np

from estimator.arrays import in_frame
from estimator.coverage import combined
from estimator.results import Estimate, SensorCalibration
from estimator.session import Array

NOT_SEEN = Estimate(None, None)
"""Stands for a parameter that a calibration does not hold at all."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """A measured change."""

    vector: Array
    """Components of the change: (1,) for scale (relative), bias (m/s²; rad/s), quadratic (s²/m); (2,) for the axis,
    along the tangents of the reference axis, rad.
    """
    current: Array
    """(1, 1) or (2, 2), the share of this session in the covariance, unit of the vector squared."""
    origin: Array
    """(1, 1) or (2, 2), the share of the reference session, which all sessions judged against it have in common, unit
    of the vector squared."""
    current_dof: float | None = None
    """Degrees of freedom of ``own``; None when the noise is known."""
    origin_dof: float | None = None
    """Degrees of freedom of ``origin``; None when the noise is known."""

    @property
    def dof(self) -> float | None:
        """Effective degrees of freedom of both together; None when the noise is known."""
        if self.current_dof is None and self.origin_dof is None:
            return None
        current, origin = float(np.trace(self.current)), float(np.trace(self.origin))
        return combined((current, self.current_dof), (origin, self.origin_dof))

    @property
    def covariance(self) -> Array:
        """Covariance of the change, from both sessions: (2, 2) for the axis, rad², otherwise (1, 1), SI or relative
        squared.
        """
        return self.current + self.origin

    @property
    def is_finite(self) -> bool:
        """Whether every number of it is known."""
        return bool(np.isfinite(self.vector).all() and np.isfinite(self.covariance).all())


def deviation(current: SensorCalibration, reference: SensorCalibration, parameter: str) -> Deviation | None:
    """Change of a parameter since the reference; None when one of the sessions does not observe it."""
    if parameter == "axis":
        return _axis_deviation(current, reference)
    now: Estimate = getattr(current, parameter) or NOT_SEEN
    old: Estimate = getattr(reference, parameter) or NOT_SEEN
    if now.value is None or old.value is None or now.sigma is None or old.sigma is None:
        return None
    if parameter == "scale" and old.value == 0:
        return None
    if parameter == "scale":
        ratio = now.value / old.value
        sigmas = now.sigma / old.value, ratio * old.sigma / old.value
        return replace(_scalar(ratio - 1, *sigmas), current_dof=now.dof, origin_dof=old.dof)
    return replace(_scalar(now.value - old.value, now.sigma, old.sigma), current_dof=now.dof, origin_dof=old.dof)


def _scalar(change: float, current: float, origin: float) -> Deviation:
    """One number with one sigma of each session."""
    return Deviation(np.array([change]), np.array([[current**2]]), np.array([[origin**2]]))


def _axis_deviation(current: SensorCalibration, reference: SensorCalibration) -> Deviation | None:
    """The current axis seen from the reference axis: angle times direction, with both covariances in one basis.

    The current tangents are projected on the reference's, which is right to second order in the angle between the axes.
    """
    if current.axis is None or reference.axis is None:
        return None
    basis = reference.axis_tangents
    covariance = in_frame(current.axis_covariance, current.axis_tangents, basis)
    offset = axis_offset(current.axis, reference.axis, basis)
    return Deviation(offset, covariance, reference.axis_covariance, current.axis_dof, reference.axis_dof)


def axis_offset(axis: Array, reference: Array, tangents: Array) -> Array:
    """(2,) angle from the reference axis times its direction along the reference's tangents, rad.

    Parameters
    ----------
    axis, reference : (3,) unit vectors, dimensionless.
    tangents : (3, 2) orthonormal columns, orthogonal to the reference, dimensionless.
    """
    across = tangents.T @ axis
    length = float(np.hypot(*across))
    angle = float(np.arctan2(length, axis @ reference))
    direction = across / length if length > 0 else np.array([1.0, 0.0])
    return angle * direction
