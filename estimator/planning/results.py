"""Requests and results of planning; no algorithms. SI throughout; scale is relative."""

from dataclasses import dataclass, field

import numpy as np

from estimator.codec import DEGREES, RUN, Document
from estimator.diagnosis.results import Limit
from estimator.planning.positions import OptimalPositions
from estimator.results import PARAMETERS, Calibration
from estimator.session import Array, CalibrationSession


@dataclass(frozen=True)
class ToleranceSet:
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
        """(4,) tolerances in the order of `PARAMETERS`, SI, relative for scale; infinite where not judged."""
        values = [getattr(self, name) for name in PARAMETERS]
        return np.array([np.inf if v is None else v for v in values], dtype=float)


@dataclass(frozen=True)
class Request:
    """Request for a plan; None lets the planner choose."""

    elevation: float | None = None
    """α, or χ of a block of gyros alone, rad."""
    positions: int | None = None
    """N of each run."""
    runs: tuple[bool, ...] = (False, True)
    """True for flipped."""
    wanted: ToleranceSet = field(default_factory=ToleranceSet)
    gyro_wanted: ToleranceSet | None = None
    """Tolerances of the gyros in a mixed block; None: the same as ``wanted``."""
    time_per_position: float = 120.0
    """s."""
    coverage: float = 2.0
    """k of the expanded uncertainty U."""
    share: float = 1 / 3
    """Largest part of a tolerance that U may take."""
    most_positions: int = 72
    """N that the planner does not go beyond."""


@dataclass(frozen=True)
class JudgedParameter:
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


@dataclass(frozen=True, eq=False)
class Sweep:
    """Expected sigmas over one setting, the worst sensor's. k settings."""

    at: Array
    """(k,) elevations in rad, or numbers of positions."""
    total: Array
    """(k, 4) one sigma by `PARAMETERS`; NaN where not observed."""
    repeatability: Array
    """(k, 4) one sigma from session to session on one stand, by `PARAMETERS`; NaN where not observed."""
    conditioning: Array
    """(k,) ρ."""


@dataclass(frozen=True, eq=False)
class Plan(
    Document,
    format="imu-plan/1",
    order=(
        "elevation", "formula_elevation", "positions", "runs", "seconds", "conditioning", "reached", "unseen",
        "judged", "limits", "optimal", "over_positions", "over_elevation",
    ),
    keys={
        "elevation": "elevation_deg", "formula_elevation": "formula_elevation_deg", "judged": "parameters",
        "optimal": "optimal_positions",
    },
    forms={"elevation": DEGREES, "formula_elevation": DEGREES, "runs": RUN},
):  # fmt: skip
    """A session proposed or judged before it is measured."""

    schedule: CalibrationSession
    """The planned session, with the readings that perfect nominal sensors would give."""
    request: Request
    elevation: float
    """rad."""
    formula_elevation: float
    """Elevation by formula (6) for this stand and N, rad."""
    positions: int
    """N of each run."""
    seconds: float
    """Time of all positions."""
    conditioning: float
    expected: Calibration
    """The calibration that the session would give: sigmas, what is observable, what is known only together."""
    judged: tuple[JudgedParameter, ...]
    limits: tuple[Limit, ...]
    """Smallest effects of every cause that the session would detect, and the causes it cannot see; empty beyond
    thousands of readings.
    """
    optimal: OptimalPositions
    over_positions: Sweep
    over_elevation: Sweep

    @property
    def runs(self) -> tuple[bool, ...]:
        """True for flipped."""
        return self.request.runs

    @property
    def reached(self) -> bool | None:
        """Whether every judged parameter leaves its tolerance the requested share; None where none is judged."""
        verdicts = {j.verdict for j in self.judged} - {"not judged"}
        return verdicts == {"enough"} if verdicts else None

    @property
    def unseen(self) -> tuple[str, ...]:
        """Names of the parameters that the plan does not observe, as ``A1.quadratic``."""
        return tuple(f"{j.sensor}.{j.parameter}" for j in self.judged if j.sigma is None)
