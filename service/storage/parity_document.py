"""imu-parity/1, as a recording's calibration holds it, back to the object that wrote it."""

from dataclasses import fields
from typing import Any

import numpy as np

from estimator.parity import ParityResult
from estimator.parity.results import Candidate, SensorParity, Sight

ARRAYS = ("constant", "slope", "covariance", "excited", "course", "course_sigma", "course_time")


def parity_from_dict(document: dict[str, Any]) -> ParityResult:
    """The result that `ParityResult.to_dict` wrote; null in an array is NaN again."""
    document = _before_motion(document) | document
    read = {entry.name: document[entry.name] for entry in fields(ParityResult)}
    read |= {name: np.array(document[name], dtype=float) for name in ARRAYS}
    read["sensors"] = tuple(map(_sensor, document["sensors"]))
    for name in ("candidates", "suspects"):
        read[name] = tuple(map(_candidate, document[name]))
    read["saturated"] = tuple(document["saturated"])
    return ParityResult(**read)


def _before_motion(document: dict[str, Any]) -> dict[str, Any]:
    """What documents lack that were written before motion was allowed for: they took it to do nothing."""
    unmoved = {"chi2_unmoved": document["chi2"], "p_value_unmoved": document["p_value"]}
    return {"clipped": {}, "moving": False, "suspects": [], "motion_share": 0.0, **unmoved}


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
