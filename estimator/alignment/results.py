"""Results of an alignment and of a rate table; no algorithms. Units: see the package page."""

from dataclasses import dataclass

import numpy as np

from estimator.codec import DEGREES, Document
from estimator.results import Estimate, Fit
from estimator.session import Array, SetAside


@dataclass(frozen=True, eq=False)
class AlignmentCourse:
    """The estimates through time. K steps, n states."""

    time: Array
    """(K,) s since the first stop began, at the end of each step."""
    estimates: Array
    """(K, n) SI."""
    sigmas: Array
    """(K, n) one sigma, SI."""
    attitude: Array
    """(K, 3, 3) computed attitude C̃, block → east-north-up; the truth is about (I + φ×)·C̃."""
    innovations: Array
    """(K, 2) innovations of the velocity, east and north, m/s."""
    innovation_sigmas: Array
    """(K, 2) their expected one sigma, m/s."""
    stop: Array
    """(K,) number of the stop that ends with this step, −1 for all other steps."""


@dataclass(frozen=True, kw_only=True)
class Listed(
    Estimate,
    order=("name", "unit", "observable", "value", "sigma", "repeatability", "dof", "coverage_factor"),
    optional=("observable",),
):
    """An estimate with its name, as documents list it."""

    name: str
    unit: str
    observable: bool | None = None
    """Whether the session determines it well enough; None where observability is not reported."""


@dataclass(frozen=True, eq=False)
class AlignmentResult(
    Document,
    format="imu-alignment/1",
    order=(
        "unit", "model", "positions", "heading", "attitude", "parameters", "names", "covariance", "fit",
    ),
    keys={
        "positions": "positions_deg", "heading": "heading_deg", "names": "covariance.names",
        "covariance": "covariance.total",
    },
    forms={"positions": DEGREES, "heading": DEGREES},
):  # fmt: skip
    """Attitude and sensor errors from one multi-position alignment. n states, named as in `sins.STATES`."""

    unit: str
    model: str
    names: tuple[str, ...]
    units: tuple[str, ...]
    estimate: Array
    """(n,) at the end, SI; ε and ∇ of the block's axes are total biases, with what coarse alignment took off."""
    covariance: Array
    """(n, n) SI."""
    observable: dict[str, bool]
    """Whether the session determines the state well enough to be of use, for φ, ε, ∇, E, κ."""
    attitude: Array
    """(3, 3) C, block → east-north-up, at the end, corrected by φ."""
    positions: tuple[float, ...]
    """Table angle of each stop, rad."""
    fit: Fit
    course: AlignmentCourse

    def parameter(self, name: str) -> Estimate:
        """Value and sigma of a state; both None when it is not observable."""
        place = self.names.index(name)
        if not self.observable.get(name, True):
            return Estimate(None, None)
        return Estimate(float(self.estimate[place]), float(np.sqrt(self.covariance[place, place])))

    @property
    def parameters(self) -> tuple[Listed, ...]:
        """The states for which observability is reported."""
        return tuple(
            Listed(**vars(self.parameter(name)), name=name, unit=unit, observable=self.observable[name])
            for name, unit in zip(self.names, self.units, strict=True)
            if name in self.observable
        )

    @property
    def heading(self) -> float:
        """Direction of the block's Y axis at the end, clockwise from north, rad in (−π, π]."""
        return float(np.arctan2(self.attitude[0, 1], self.attitude[1, 1]))


@dataclass(frozen=True, eq=False)
class RateTableResult(
    Document,
    format="imu-rate-table/1",
    order=("unit", "turns", "rates_deg_s", "parameters", "names", "covariance", "fit", "set_aside"),
    optional=("set_aside",),
    keys={"names": "covariance.names", "covariance": "covariance.total"},
):
    """Mounting errors, azimuth scale and biases of a block's gyros from whole turns both ways."""

    unit: str
    names: tuple[str, ...]
    """E_xz, E_yz, kappa_z, eps_x, eps_y, eps_z."""
    units: tuple[str, ...]
    estimate: Array
    """(6,) estimated values in `units`; NaN for what is not known."""
    covariance: Array
    """(6, 6) covariance in `units`; NaN rows and columns for what is not known."""
    turn_rates: Array
    """(T,) rate of the table in every whole turn, rad/s."""
    turn_times: Array
    """(T,) middle of every turn, s."""
    residuals: Array
    """(T, 3) mean rates of the turns minus the model's, block axes, rad/s."""
    residual_sigma: Array
    """(T, 3) rad/s."""
    fit: Fit
    set_aside: tuple[SetAside, ...] = ()
    """Gross readings, which took no part."""

    def parameter(self, name: str) -> Estimate:
        """Value and sigma; both None when it is not known."""
        place = self.names.index(name)
        if not np.isfinite(self.estimate[place]):
            return Estimate(None, None)
        return Estimate(float(self.estimate[place]), float(np.sqrt(self.covariance[place, place])))

    @property
    def turns(self) -> int:
        """Number of whole turns."""
        return len(self.turn_rates)

    @property
    def rates_deg_s(self) -> list[float]:
        """The different rates, °/s."""
        return sorted({round(float(rate), 6) for rate in np.degrees(self.turn_rates)})

    @property
    def parameters(self) -> tuple[Listed, ...]:
        """All, with their names."""
        named = zip(self.names, self.units, strict=True)
        return tuple(Listed(**vars(self.parameter(name)), name=name, unit=unit) for name, unit in named)
