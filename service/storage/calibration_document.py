"""imu-calibration/1 as it is kept, and back to the object that wrote it."""

import zlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.results import (
    Calibration,
    Estimate,
    Fit,
    KnownCombination,
    Residuals,
    SensorCalibration,
)
from estimator.session import Array
from service.storage.json_text import json_text

LEVEL = 4
"""Of deflate: 4 % more bytes than the usual 6, in 40 % of the time; an upload waits for it."""


@dataclass(frozen=True)
class Packed:
    """A calibration as it is kept."""

    method: str
    document: bytes
    """The whole imu-calibration/1, deflated."""


def pack(calibration: Calibration) -> Packed:
    """Ready to be stored, so that no transaction waits for it."""
    return Packed(calibration.method, zlib.compress(json_text(calibration.to_dict()).encode(), LEVEL))


def calibration_from_dict(document: dict[str, Any]) -> Calibration:
    """The calibration that `Calibration.to_dict` wrote; null is NaN again."""
    covariance = document["covariance"]
    return Calibration(
        unit=document["unit"],
        method=document["method"],
        sensors=tuple(_sensor(entry) for entry in document["sensors"]),
        names=tuple(covariance["names"]),
        units=tuple(covariance["units"]),
        covariance=_numbers(covariance["total"]),
        repeatability=_numbers(covariance["repeatability"]),
        fit=_fit(document["fit"]),
        residuals=residuals_from_dict(document["residuals"]),
        gauge=document["gauge"],
        parity=document.get("parity"),
    )


def _numbers(listed: Any) -> Array:
    """Nested lists with null to an array of their shape with NaN, in the unit that the document states."""
    return np.array(listed, dtype=float)


def _sensor(entry: dict[str, Any]) -> SensorCalibration:
    axis = entry["axis"]
    return SensorCalibration(
        name=entry["name"],
        kind=entry["kind"],
        scale=_estimate(entry["scale"]),
        bias=_estimate(entry["bias"]),
        quadratic=_estimate(entry["quadratic"]),
        axis=None if axis["value"] is None else _numbers(axis["value"]),
        axis_tangents=_numbers(axis["tangents"]),
        axis_covariance=_numbers(axis["covariance"]),
        observable=dict(entry["observable"]),
        known=tuple(KnownCombination(**known) for known in entry["known_combinations"]),
        misalignment=_estimate(entry["misalignment"]) if "misalignment" in entry else None,
        axis_dof=axis.get("dof"),
    )


def _estimate(entry: dict[str, Any]) -> Estimate:
    """Its coverage factor follows from the degrees of freedom, which older documents lack."""
    return Estimate(entry["value"], entry["sigma"], entry["repeatability"], entry.get("dof"))


def _fit(entry: dict[str, Any]) -> Fit:
    weakest = entry["weakest"]
    add = tuple(tuple(direction) for direction in entry.get("add", ()))
    return Fit(**{**entry, "weakest": (weakest["parameter"], weakest["sigma"]), "add": add})


def residuals_from_dict(entry: dict[str, Any]) -> Residuals:
    """The residuals that `Residuals.to_dict` wrote."""
    run = entry["run"]
    return Residuals(
        value=_numbers(entry["value"]),
        sigma=_numbers(entry["sigma"]),
        beta=None if entry["beta_deg"] is None else np.radians(_numbers(entry["beta_deg"])),
        flipped=None if run is None else np.array([name == "flipped" for name in run]),
        time=None if entry["time_s"] is None else _numbers(entry["time_s"]),
        temperature=None if entry["temperature_c"] is None else _numbers(entry["temperature_c"]),
        enlarged_by=entry.get("enlarged_by"),  # absent from earlier versions
    )
