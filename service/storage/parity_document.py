"""imu-parity/1, as a recording's calibration holds it, back to the object that wrote it."""

from dataclasses import fields
from typing import Any

import numpy as np

from estimator.parity import ParityResult
from estimator.parity.results import Candidate, SensorParity, Sight

ARRAYS = ("constant", "slope", "covariance", "excited", "course", "course_sigma", "course_time")


def parity_from_dict(document: dict[str, Any]) -> ParityResult:
    """The result that `ParityResult.to_dict` wrote; null in an array is NaN again."""
    read = {entry.name: document[entry.name] for entry in fields(ParityResult)}
    read |= {name: np.array(document[name], dtype=float) for name in ARRAYS}
    read["sensors"] = tuple(map(_sensor, document["sensors"]))
    read["candidates"] = tuple(map(_candidate, document["candidates"]))
    read["saturated"] = tuple(document["saturated"])
    return ParityResult(**read)


def _sensor(entry: dict[str, Any]) -> SensorParity:
    sights = {name: _sight(entry[name]) for name in ("bias", "scale", "axis")}
    return SensorParity(name=entry["name"], visible_share=entry["visible_share"], **sights)


def _sight(entry: dict[str, Any]) -> Sight:
    change, covariance = entry["change"], entry["covariance"]
    return Sight(
        change=None if change is None else tuple(change),
        covariance=None if covariance is None else tuple(map(tuple, covariance)),
        detectable=entry["detectable"],
        isolable=entry["isolable"],
    )


def _candidate(entry: dict[str, Any]) -> Candidate:
    return Candidate(**{**entry, "amplitude": tuple(entry["amplitude"]), "sigma": tuple(entry["sigma"])})
