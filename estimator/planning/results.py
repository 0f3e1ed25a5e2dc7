"""What planning is asked and what it answers; no algorithms. SI throughout; scale is relative."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from estimator.diagnosis.results import Limit
from estimator.planning.positions import OptimalPositions
from estimator.results import PARAMETERS, Calibration, json_numbers
from estimator.session import Array, CalibrationSession


@dataclass(frozen=True)
class Wanted:
    """Tolerances that a parameter is to be judged against; None where it is not judged."""

    scale: float | None = None
    """Relative."""
    bias: float | None = None
    """m/s² (rad/s)."""
    quadratic: float | None = None
    """s²/m (s/rad)."""
    axis: float | None = None
    """rad."""

    def row(self) -> Array:
        """(4,) in the order of `PARAMETERS`, SI, relative for scale; infinite where not judged."""
        values = [getattr(self, name) for name in PARAMETERS]
        return np.array([np.inf if v is None else v for v in values], dtype=float)


@dataclass(frozen=True)
class Request:
    """What is asked of a plan; None lets the planner choose."""

    elevation: float | None = None
    """α, or χ of a block of gyros alone, rad."""
    positions: int | None = None
    """N of each run."""
    runs: tuple[bool, ...] = (False, True)
    """True for flipped."""
    wanted: Wanted = field(default_factory=Wanted)
    gyro_wanted: Wanted | None = None
    """For the gyros of a mixed block; None: the same as ``wanted``."""
    time_per_position: float = 120.0
    """s."""
    coverage: float = 2.0
    """k of the expanded uncertainty U."""
    share: float = 1 / 3
    """Largest part of a tolerance that U may take."""
    most_positions: int = 72
    """N that the planner does not go beyond."""


@dataclass(frozen=True)
class Judged:
    """One expected parameter of one sensor."""

    sensor: str
    kind: str
    parameter: str
    sigma: float | None
    """Total one sigma; None when the plan does not observe it."""
    repeatability: float | None
    tolerance: float | None
    verdict: str
    """``enough`` (U within the share), ``usable`` (U within the tolerance), ``undecidable``, or ``not judged``."""

    def to_dict(self) -> dict[str, Any]:
        return {
            "sensor": self.sensor,
            "kind": self.kind,
            "parameter": self.parameter,
            "sigma": self.sigma,
            "repeatability": self.repeatability,
            "tolerance": self.tolerance,
            "verdict": self.verdict,
        }


@dataclass(frozen=True, eq=False)
class Sweep:
    """Expected sigmas over one setting, the worst sensor's. k settings."""

    at: Array
    """(k,) elevations in rad, or numbers of positions."""
    total: Array
    """(k, 4) one sigma by `PARAMETERS`; NaN where not observed."""
    repeatability: Array
    """(k, 4) the same from session to session on one stand."""
    conditioning: Array
    """(k,) ρ."""

    def to_dict(self) -> dict[str, Any]:
        return {
            "at": self.at.tolist(),
            "total": json_numbers(self.total),
            "repeatability": json_numbers(self.repeatability),
            "conditioning": json_numbers(self.conditioning),
        }


@dataclass(frozen=True, eq=False)
class Plan:
    """A session proposed or judged before it is measured."""

    schedule: CalibrationSession
    """With the readings that perfect nominal sensors would give."""
    request: Request
    elevation: float
    """rad."""
    formula_elevation: float
    """(6) for this stand and N, rad."""
    positions: int
    """N of each run."""
    seconds: float
    """Time of all positions."""
    conditioning: float
    expected: Calibration
    """The calibration that the session would give: sigmas, what is observable, what is known only together."""
    judged: tuple[Judged, ...]
    limits: tuple[Limit, ...]
    """What the session would detect of every cause and which it cannot see; none beyond thousands of readings."""
    optimal: OptimalPositions
    over_positions: Sweep
    over_elevation: Sweep

    @property
    def reached(self) -> bool | None:
        """Whether every judged parameter leaves its tolerance the share that was asked for; None where none is."""
        verdicts = {j.verdict for j in self.judged} - {"not judged"}
        return verdicts == {"enough"} if verdicts else None

    @property
    def unseen(self) -> tuple[str, ...]:
        """``A1.quadratic``, …: what the plan does not observe."""
        return tuple(f"{j.sensor}.{j.parameter}" for j in self.judged if j.sigma is None)

    def to_dict(self) -> dict[str, Any]:
        """``imu-plan/1``."""
        return {
            "format": "imu-plan/1",
            "elevation_deg": float(np.degrees(self.elevation)),
            "formula_elevation_deg": float(np.degrees(self.formula_elevation)),
            "positions": self.positions,
            "runs": ["flipped" if f else "direct" for f in self.request.runs],
            "seconds": self.seconds,
            "conditioning": self.conditioning if np.isfinite(self.conditioning) else None,
            "reached": self.reached,
            "unseen": list(self.unseen),
            "parameters": [j.to_dict() for j in self.judged],
            "limits": [limit.to_dict() for limit in self.limits],
            "optimal_positions": self.optimal.to_dict(),
            "over_positions": self.over_positions.to_dict(),
            "over_elevation": self.over_elevation.to_dict(),
        }
