"""The inputs that terms change: those of all readings, then the parameters that the history holds."""

from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.posterior.priors import units
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class InputLayout:
    """D = R·m + P inputs: of R rows of m sensors, row by row, and of P parameters; P is 0 without a history."""

    R: int
    m: int
    P: int
    unit: Array
    """(m,) m/s² (rad/s): a unit of size of each sensor, `priors.units`."""
    norm: Array
    """(m,) length of the applied vector, m/s² (rad/s)."""

    @classmethod
    def of(cls, residuals: WhitenedResiduals) -> "InputLayout":
        """The layout of a session."""
        setting, m = residuals.baseline.setting, len(residuals.baseline.unstated)
        P = 0 if residuals.change is None else len(residuals.change.deviation)
        norm = np.broadcast_to(setting.norm, (m,))
        return cls(setting.rows, m, P, units(setting.kinds, norm), norm)

    @property
    def D(self) -> int:
        """Number of inputs."""
        return self.R * self.m + self.P

    def readings(self, i: int) -> Array:
        """(R,) the places of sensor i's readings."""
        return np.arange(self.R) * self.m + i

    def of_sensor(self, i: int) -> Array:
        """(R + P,) the places of sensor i's readings and of all parameters."""
        return np.concatenate([self.readings(i), self.R * self.m + np.arange(self.P)])

    def on_sensor(self, i: int, columns: Array) -> Array:
        """(D, q) columns (R, q), any unit, of sensor i."""
        whole = np.zeros((self.D, columns.shape[1]))
        whole[self.readings(i)] = columns
        return whole

    def whole(self, columns: Array, before: Array | None = None) -> Array:
        """(D, q) columns (R, m, q), any unit, and what the history absorbed of them, (P, q); nothing where None."""
        q = columns.shape[-1]
        before = np.zeros((self.P, q)) if before is None else before
        return np.concatenate([columns.reshape(-1, q), before])
