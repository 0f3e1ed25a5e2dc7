"""What naming the causes is worth, and what moved because of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from math import isclose
from typing import Any

import numpy as np

from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.measures import deviation_measure, measured, number
from service.records.diagnosis import StoredDiagnosis
from service.records.session import StoredSession
from service.words.conditions import Condition, condition_of

WORTH_A_LINE = 0.02

SAME = 1e-3
"""Relative change of a score that nobody would call a gain."""


@dataclass(frozen=True)
class GainRow:
    """One measure of prediction, before and after."""

    name: str
    meaning: str
    before: str
    after: str


@dataclass(frozen=True)
class Moved:
    """How far one sensor's parameters moved because the causes are in the model."""

    sensor: str
    scale: str
    bias: str
    axis: str


@dataclass(frozen=True)
class GainView:
    """The gain of the extended model."""

    is_none: bool
    """Whether the named causes show elsewhere than in the prediction of held-out readings."""
    rows: tuple[GainRow, ...]
    """Positions of this session that took no part in the fit."""
    earlier_rows: tuple[GainRow, ...]
    """The earlier session, with the size found in this one; empty where the causes cannot have acted there."""
    earlier_at: datetime | None
    moved: tuple[Moved, ...]
    """Sensors of which anything moved."""
    verdict_before: Condition
    verdict_after: Condition | None


def gain_view(
    document: dict[str, Any], found: StoredDiagnosis, session: StoredSession, before: Calibration, after: Calibration
) -> GainView:
    """Before is the calibration in force, after the one with the named causes."""
    gain = document["gain"]
    earlier = gain.get("session")  # absent from documents of earlier versions
    kind = GYROSCOPE if {sensor.kind for sensor in after.sensors} == {GYROSCOPE} else ACCELEROMETER
    return GainView(
        is_none=all(isclose(gain["before"][key], gain["after"][key], rel_tol=SAME) for key in gain["before"]),
        rows=_rows(gain, kind),
        earlier_rows=() if earlier is None else _rows(earlier, kind),
        earlier_at=None if earlier is None else at(earlier["started_at"]),
        moved=tuple(
            _moved(a, b)
            for a, b in zip(before.sensors, after.sensors, strict=False)
            if a.name == b.name and _has_moved(a, b)
        ),
        verdict_before=condition_of(session.verdict),
        verdict_after=None if found.verdict_after is None else condition_of(found.verdict_after),
    )


def at(started_at: str | None) -> datetime | None:
    """When a session began; None where its file does not say."""
    return None if started_at is None else datetime.fromisoformat(started_at)


def _rows(gain: dict[str, Any], kind: str) -> tuple[GainRow, ...]:
    before, after = gain["before"], gain["after"]
    unit = deviation_measure(kind, "bias", max(_known(before["rms"]), _known(after["rms"])))
    measures: Sequence[tuple[str, str, str, float]] = (
        ("rms", f"error of prediction, {unit.label}", "rms", unit.factor),
        ("χ² per degree of freedom", "1 where the noise explains the errors", "chi2_per_dof", 1.0),
        ("log score", "of a reading; higher is better", "log_score", 1.0),
    )
    return tuple(
        GainRow(name, meaning, *(number(_scaled(part[key], factor), 3) for part in (before, after)))
        for name, meaning, key, factor in measures
    )


def _known(value: float | None) -> float:
    return 0.0 if value is None else abs(value)


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else value * factor


def _has_moved(before: SensorCalibration, after: SensorCalibration) -> bool:
    """Whether any parameter moved by a share of its uncertainty that is worth a line."""
    pairs = ((before.scale, after.scale), (before.bias, after.bias))
    shifts = [
        abs(b.value - a.value) > WORTH_A_LINE * b.sigma
        for a, b in pairs
        if a.value is not None and b.value is not None and b.sigma
    ]
    turned = before.axis is not None and after.axis is not None and after.axis_sigma is not None
    if turned:
        angle = float(np.linalg.norm(np.cross(before.axis, after.axis)))  # type: ignore[arg-type]  # checked above
        shifts.append(angle > WORTH_A_LINE * (after.axis_sigma or 0.0))
    return any(shifts)


def _moved(before: SensorCalibration, after: SensorCalibration) -> Moved:
    return Moved(
        sensor=after.name,
        scale=_relative(before.scale, after.scale, after.kind),
        bias=_change(before.bias, after.bias, after.kind),
        axis=_turned(before, after),
    )


def _relative(before: Estimate, after: Estimate, kind: str) -> str:
    if before.value is None or after.value is None or after.sigma is None:
        return "–"
    change, sigma = after.value / before.value - 1, after.sigma / abs(after.value)
    return measured(change, sigma, deviation_measure(kind, "scale", max(abs(change), sigma)))


def _change(before: Estimate, after: Estimate, kind: str) -> str:
    if before.value is None or after.value is None or after.sigma is None:
        return "–"
    change = after.value - before.value
    return measured(change, after.sigma, deviation_measure(kind, "bias", max(abs(change), after.sigma)))


def _turned(before: SensorCalibration, after: SensorCalibration) -> str:
    if before.axis is None or after.axis is None or after.axis_sigma is None:
        return "–"
    angle = float(np.linalg.norm(np.cross(before.axis, after.axis)))
    return measured(angle, after.axis_sigma, deviation_measure(after.kind, "axis", max(angle, after.axis_sigma)))
