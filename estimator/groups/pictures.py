"""What sessions leave, pooled over what it depends on: measured minus simulated without an effect and with it.

Residuals of all sessions are averaged in bins of one variable, each with the weight of its noise. What the calibration
absorbs of the effect is in neither: the picture shows what can be seen.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.causes.catalogue import cause
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.fixed import added_by, fixed
from estimator.groups.layout import EVERY
from estimator.groups.results import GroupFinding
from estimator.session import Array, CalibrationSession

BINS = 24
"""Points of a picture: fewer hide a third harmonic, more are noise."""
BETA, TEMPERATURE, TIME, INPUT = "β", "(T − T̄)", "(t − t̄)", "a"
"""What a picture is drawn over: rad, K, s, and the input as a part of the applied vector."""


@dataclass(frozen=True, eq=False)
class Pictured:
    """One session of a picture. R rows."""

    at: Array
    """(R,)"""
    before: Array
    """(R,) m/s² (rad/s)"""
    after: Array
    """(R,) m/s² (rad/s)"""
    variance: Array
    """(R,) of the readings."""


def pictures(findings: Sequence[GroupFinding], sessions: Sequence[CalibrationSession]) -> list[dict[str, Any] | None]:
    """One a finding; None where the sessions are not at hand or show nothing of it."""
    whole = [WhitenedResiduals.of(baseline_of(averaged(s))) for s in sessions] if findings else []
    return [_picture_of(finding, whole) for finding in findings]


def _picture_of(finding: GroupFinding, whole: Sequence[WhitenedResiduals]) -> dict[str, Any] | None:
    parts, sensor = [], ""
    variable = variable_of(finding)
    for residuals in whole:
        baseline, session = residuals.baseline, residuals.baseline.session
        subjects = (session.unit, session.unit_type, session.stand.id if session.stand else "")
        added = added_by(baseline, [fixed(finding)], ()) if finding.subject in subjects else None
        if added is None:
            continue
        effect = added.columns @ added.amplitude
        names = [s.name for s in session.sensors]
        sensor = sensor if sensor in names else names[place_of(finding, names, effect)]
        i = names.index(sensor)
        left = left_without(residuals, effect)[:, i]
        at = values_of(baseline, i, variable)
        parts.append(Pictured(at, baseline.residual[:, i], left, variance_of(baseline, i)))
    return pooled_picture(parts, variable) | {"sensor": sensor} if parts else None


def place_of(finding: GroupFinding, names: Sequence[str], effect: Array) -> int:
    """The sensor that is drawn: the finding's first, or the one on which the effect is largest."""
    own = [names.index(s) for s in finding.sensors if s in names]
    return own[0] if own else int(np.argmax((effect**2).sum(axis=0)))


def variable_of(finding: GroupFinding) -> str:
    """What an effect depends on most plainly."""
    known = cause(finding.cause)
    if "temperature" in known.needs:
        return TEMPERATURE
    if "time" in known.needs:
        return TIME
    return INPUT if finding.sensors and EVERY not in finding.sensors else BETA


def pooled_picture(parts: Sequence[Pictured], variable: str) -> dict[str, Any]:
    """Mean of each bin, before and after, with its standard uncertainty; m/s² (rad/s)."""
    place = np.concatenate([p.at for p in parts])
    weight = np.concatenate([p.variance for p in parts]) ** -1.0
    edges = np.linspace(place.min(), place.max() + 1e-12, BINS + 1)
    number = np.clip(np.digitize(place, edges) - 1, 0, BINS - 1)
    total = np.bincount(number, weights=weight, minlength=BINS)
    seen = total > 0
    mean = [
        np.bincount(number, weights=weight * np.concatenate(v), minlength=BINS)[seen] / total[seen]
        for v in ([p.before for p in parts], [p.after for p in parts])
    ]
    return {
        "variable": variable,
        "at": ((edges[1:] + edges[:-1]) / 2)[seen].tolist(),
        "before": mean[0].tolist(),
        "after": mean[1].tolist(),
        "sigma": (total[seen] ** -0.5).tolist(),
    }


def left_without(residuals: WhitenedResiduals, effect: Array) -> Array:
    """(R, m) m/s² (rad/s): what the calibration leaves once an effect (R, m) is taken out."""
    step = residuals.response @ residuals.whitened(effect[..., None])[:, 0]
    baseline = residuals.baseline
    absorbed = (baseline.design * step.reshape(effect.shape[1], 5)).sum(axis=-1)
    return np.asarray(baseline.residual - (effect - absorbed))


def variance_of(baseline: Baseline, i: int) -> Array:
    """(R,) of a sensor's readings, with what the stand's errors of each row add, (m/s²)² ((rad/s)²)."""
    sigma = np.where(np.isfinite(baseline.row_sigma), baseline.row_sigma, 0.0)
    return np.asarray(baseline.variance[:, i] + ((baseline.row[:, i] * sigma) ** 2).sum(axis=-1))


def values_of(baseline: Baseline, i: int, variable: str) -> Array:
    """(R,) of what a picture is drawn over; the input of the sensor where the session lacks it."""
    setting = baseline.setting
    if variable == TIME and setting.time is not None:
        return setting.time - setting.time.mean()
    if variable in (TEMPERATURE, "dT/dt") and setting.temperature is not None:
        return setting.temperature - setting.temperature.mean()
    if variable == BETA and setting.beta is not None:
        return np.mod(setting.beta, 2 * np.pi)
    return setting.a[:, i] / setting.norm[i]
