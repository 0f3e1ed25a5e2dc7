"""Control charts of a unit's history: Page's sum and Wald's sequential ratio, of every parameter of each sensor."""

from collections.abc import Callable

import numpy as np

from benchmarks.backtest.histories import History
from benchmarks.backtest.watching import from_mean, summed, wald
from benchmarks.blind.given import Claim, Given
from estimator import calibrate
from estimator.results import SensorCalibration
from estimator.session import Array

Chart = Callable[[Array], Array]


def cusum(given: Given) -> list[Claim]:
    """Page's sum at the newest session."""
    return charted(given, summed)


def sprt(given: Given) -> list[Claim]:
    """Wald's ratio at the newest session."""
    return charted(given, wald)


def charted(given: Given, chart: Chart) -> list[Claim]:
    """Every sensor as changed since the history, by its most suspect parameter, the most suspect sensor first."""
    if not given.history:
        return []
    lives = zip(*(calibrate(s).sensors for s in (*given.history, given.session)), strict=True)
    claims = [Claim(suspicion(life, chart), {"cause": "sensor-drift", "sensors": [life[-1].name]}) for life in lives]
    return sorted(claims, key=lambda claim: -claim.statistic)


def suspicion(life: tuple[SensorCalibration, ...], chart: Chart) -> float:
    """The chart's largest figure at the newest session, for one sensor through its sessions, oldest first."""
    values, sigmas = (np.array(x) for x in zip(*(parameters(s, life[-1]) for s in life), strict=True))
    known = np.flatnonzero(np.isfinite(values + sigmas).all(axis=0))
    time = np.arange(len(life), dtype=float)
    tracks = (History("", values[:0, 0], 0.0, time, values[:, k], sigmas[:, k], time) for k in known)
    return max((float(chart(from_mean(track))[-1]) for track in tracks), default=0.0)


def parameters(sensor: SensorCalibration, newest: SensorCalibration) -> tuple[Array, Array]:
    """(5,) values and (5,) sigmas, SI: scale, bias, quadratic term, and how the axis stands to the newest session's."""
    parts = (sensor.scale, sensor.bias, sensor.quadratic)
    values, sigmas = (np.array([getattr(p, name) for p in parts], dtype=float) for name in ("value", "sigma"))
    turned = np.full(2, np.nan) if sensor.axis is None else newest.axis_tangents.T @ sensor.axis
    return np.append(values, turned), np.append(sigmas, np.sqrt(np.diagonal(sensor.axis_covariance)))
