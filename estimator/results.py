"""Result types of calibration; no algorithms. Every estimate carries covariance, residuals, degrees of freedom, names.

The JSON form is ``imu-calibration/1``.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from estimator.codec import DEGREES, RUN, Document, named
from estimator.coverage import coverage_factor
from estimator.curves import ThermalCurves
from estimator.json_object import Json
from estimator.session import Array, ScreenFinding, SetAside, Site

ARCSEC = np.pi / 180 / 3600
"""rad."""
NOMINAL_AXES = "nominal-axes"
"""The gauge of a calibration whose frame the nominal axes hold."""
COVERAGE = 2.0
"""Coverage factor for known noise, 95.45 %; with few degrees of freedom it is Student's t of the same probability."""
PARAMETERS = ("scale", "bias", "quadratic", "axis")
"""Parameters of a sensor, as people judge them: the axis with both its turns."""


@dataclass(frozen=True)
class Estimate(Document, order=("value", "sigma", "repeatability", "dof", "coverage_factor")):
    """A value with its total one-sigma uncertainty.

    Both None when the session does not observe it; ``sigma`` None alone when the noise cannot be estimated.
    """

    value: float | None
    sigma: float | None
    repeatability: float | None = None
    """One sigma of what differs from session to session on one stand (reading noise, bias repeatability, δβ)."""
    dof: float | None = None
    """Effective degrees of freedom of sigma; None when the noise is known."""

    def factor(self, k: float = COVERAGE) -> float:
        """The coverage factor that covers of this estimate what ``k`` covers when the noise is known."""
        return coverage_factor(k, self.dof)

    @property
    def coverage_factor(self) -> float | None:
        """The coverage factor for `COVERAGE`; None where sigma is not known."""
        return None if self.sigma is None else self.factor()


@dataclass(frozen=True)
class KnownCombination:
    """A linear combination of parameters that is known although its parts are not: Σ coefficient·parameter."""

    coefficients: dict[str, float]
    value: float
    sigma: float | None
    """One sigma of the value; None when the noise cannot be estimated."""


class TurnsOutcome(StrEnum):
    """The use made of the turns by hand in a log of gyros."""

    USED = "used"
    """Scale factors and axes come from them."""
    SCATTERED = "scattered"
    """They scatter too much beside the recording's noise to be used."""
    UNDETERMINED = "undetermined"
    """They do not determine scale factors and axes."""
    AVERAGED = "averaged"
    """The log was averaged while it was scanned, so that it holds none."""


@dataclass(frozen=True)
class HandTurns(Document, optional=("turns", "parities")):
    """The turns by hand between the rests of a log; unless they are used, the gyros keep their biases alone."""

    outcome: TurnsOutcome
    turns: float | None = None
    """Scatter of the turns, in that of the recording's noise, where that was estimated; 1 where noise explains it."""
    parities: float | None = None
    """Scatter of the gyros among one another in the turns, likewise."""

    @property
    def scatter(self) -> float:
        """The larger of both; 1 where none was estimated."""
        return max(self.turns or 1.0, self.parities or 1.0)


@dataclass(frozen=True, eq=False)
class ForceAnswer(Document):
    """g-sensitivity of a gyro: its reading for specific force, at the input."""

    value: Array
    """(3,) (rad/s)/(m/s²), block axes."""
    covariance: Array
    """(3, 3) total, ((rad/s)/(m/s²))²."""


@dataclass(frozen=True, eq=False)
class SensorCalibration(
    Document,
    order=(
        "name", "kind", "scale", "bias", "quadratic", "axis", "axis_sigma_arcsec", "axis_tangents", "axis_covariance",
        "axis_dof", "axis_coverage_factor", "misalignment", "g_sensitivity", "observable", "known",
    ),
    keys={
        "axis": "axis.value", "axis_sigma_arcsec": "axis.sigma_arcsec", "axis_tangents": "axis.tangents",
        "axis_covariance": "axis.covariance", "axis_dof": "axis.dof", "axis_coverage_factor": "axis.coverage_factor",
        "known": "known_combinations",
    },
    optional=("misalignment", "g_sensitivity"),
):  # fmt: skip
    """Calibration of one sensor. Units: see the package page."""

    name: str
    kind: str
    scale: Estimate
    bias: Estimate
    quadratic: Estimate
    axis: Array | None
    """(3,) unit vector, block axes; None when not observable."""
    axis_tangents: Array
    """(3, 2) the two unit vectors along which axis_1 and axis_2 of the covariance turn the axis."""
    axis_covariance: Array
    """(2, 2) total covariance of (axis_1, axis_2), rad²; NaN when not observable."""
    observable: dict[str, bool]
    """Keys scale, bias, quadratic, axis; of a session that does not speak of all of them, those that it speaks of."""
    known: tuple[KnownCombination, ...] = ()
    """Known combinations of the parameters that are not observable one by one."""
    misalignment: Estimate | None = None
    """Turn of a gyro's input axis toward the axis of a turntable (E_xz, E_yz), rad; only of sessions on one."""
    axis_dof: float | None = None
    """Effective degrees of freedom of the axis' covariance; None when the noise is known."""
    g_sensitivity: ForceAnswer | None = None
    """Answer of a gyro to specific force, where it was turned by hand and plainly has one; its bias is then that
    without force."""

    @property
    def axis_sigma(self) -> float | None:
        """Root of the trace of the axis' covariance, rad; None when not observable or the noise is unknown."""
        if self.axis is None or not np.isfinite(self.axis_covariance).all():
            return None
        return float(np.sqrt(np.trace(self.axis_covariance)))

    @property
    def axis_sigma_arcsec(self) -> float | None:
        """`axis_sigma` in arcsec."""
        return None if self.axis_sigma is None else self.axis_sigma / ARCSEC

    @property
    def axis_coverage_factor(self) -> float | None:
        """Coverage factor of the axis, by `COVERAGE`; None where its sigma is not known."""
        return None if self.axis_sigma is None else self.factor("axis")

    def factor(self, parameter: str, k: float = COVERAGE) -> float:
        """The coverage factor of a parameter that covers what ``k`` covers when the noise is known."""
        if parameter == "axis":
            return coverage_factor(k, self.axis_dof)
        estimate: Estimate | None = getattr(self, parameter)
        return k if estimate is None else estimate.factor(k)


@dataclass(frozen=True)
class Fit(Document, forms={"weakest": named("parameter", "sigma")}):
    """Quality of the fit to the readings."""

    chi2: float
    dof: int
    p_value: float | None
    """Probability of a χ² at least this large under the stated noise; None when no noise was stated."""
    residual_rms: float
    """Root mean square of the residuals at the input, m/s² (rad/s)."""
    noise: str
    """``stated``, or ``estimated`` when the file gives no standard errors."""
    covariance_factor: float
    """χ² per degree of freedom by which the noise was enlarged because the stated one cannot explain the residuals;
    1 when it can."""
    rank: int
    parameters: int
    weakest: tuple[str, float]
    """The least known direction: the parameter that leads it and its one sigma, relative to what it could be."""
    iterations: int
    converged: bool
    add: tuple[tuple[float, float, float], ...] = ()
    """Directions of up, block axes, of still orientations that would complete a set that leaves something open."""
    positions_to_add: int = 0
    """Positions to add so that the readings tell their noise; 0 when the uncertainties are known."""

    @property
    def is_exact(self) -> bool:
        """Whether the fit is exact: no degree of freedom is left over to judge the model by."""
        return self.dof < 1


@dataclass(frozen=True, eq=False)
class Residuals(
    Document,
    keys={"beta": "beta_deg", "flipped": "run", "time": "time_s", "temperature": "temperature_c"},
    forms={"beta": DEGREES, "flipped": RUN},
):
    """Measured minus modelled, row by row, at the input. R rows of the averaged session, m sensors."""

    value: Array
    """(R, m), m/s² (rad/s)."""
    sigma: Array
    """(R, m) one sigma of each residual, m/s² (rad/s): the reading's own noise and the row's share of the β error."""
    beta: Array | None
    """(R,) rad, or None without a stand."""
    flipped: Any
    """(R,) bool, or None without a stand."""
    time: Array | None
    """(R,) s, or None."""
    temperature: Array | None
    """(R,) °C, or None."""
    enlarged_by: float | None = None
    """Ratio of ``sigma`` to the noise as stated or, where it was not, estimated; None where unknown."""


@dataclass(frozen=True, eq=False)
class Calibration(
    Document,
    format="imu-calibration/1",
    order=(
        "unit", "method", "sensors", "fit", "gauge", "names", "units", "covariance", "repeatability", "residuals",
        "site", "parity", "thermal", "screening", "set_aside", "hand_turns",
    ),
    keys={
        "names": "covariance.names", "units": "covariance.units",
        "covariance": "covariance.total", "repeatability": "covariance.repeatability",
    },
    optional=("site", "parity", "thermal", "screening", "set_aside", "hand_turns"),
):  # fmt: skip
    """The calibration of one block: m sensors, P = 5 m parameters with their joint covariance."""

    unit: str
    method: str
    """``two-axis-stand/maximum-likelihood`` or ``arbitrary-orientations/maximum-likelihood``."""
    sensors: tuple[SensorCalibration, ...]
    names: tuple[str, ...]
    """(P,) ``A1.scale``, ``A1.bias``, ``A1.quadratic``, ``A1.axis_1``, ``A1.axis_2``, ``A2.scale``, …"""
    units: tuple[str, ...]
    """(P,) SI unit of every element."""
    covariance: Array
    """(P, P) total covariance, SI; NaN rows and columns for what is not observable."""
    repeatability: Array
    """(P, P) the part that differs from session to session on one stand."""
    fit: Fit
    residuals: Residuals
    gauge: str
    """Reference that holds the block's frame: ``stand``, ``directions`` or ``nominal-axes`` (no net turn of all
    axes).
    """
    site: Site | None = None
    """Site of the session, as stated, SI; None of a result of an earlier version."""
    parity: Json | None = None
    """``imu-parity/1``, where the calibration is a reference moved by what a recording shows."""
    thermal: ThermalCurves | None = None
    """Bias and scale factor over temperature, of a thermal programme; everything else is at its reference."""
    screening: tuple[ScreenFinding, ...] = ()
    """Findings of the screening of the raw rows that it was made of, before they were averaged."""
    set_aside: tuple[SetAside, ...] = ()
    """Gross readings that took no part."""
    hand_turns: HandTurns | None = None
    """Turns by hand of a log with accelerometers and three or more gyros; None of any other session."""

    def sensor(self, name: str) -> SensorCalibration:
        """The calibration of the sensor called ``name``; KeyError if there is none."""
        for sensor in self.sensors:
            if sensor.name == name:
                return sensor
        raise KeyError(name)
