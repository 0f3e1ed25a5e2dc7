"""Residuals of the sessions, pooled over the variable they depend on, without an effect in the model and with it.

Residuals of all sessions are averaged in bins of one variable, each with the weight of its noise. What the calibration
absorbs of the effect is in neither: the picture shows what can be seen. Of an effect on the applied vector that is the
angle by which the head seems to stand off at each row, from all sensors together: with their slopes s per rad and
variances v the angle is Σ(s·r/v)/Σ(s²/v) of their residuals r, its variance 1/Σ(s²/v) and that of the head's own error.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.causes.catalogue import cause
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.fixed import added_by, fixed
from estimator.groups.layout import EVERY
from estimator.groups.results import GroupFinding, Picture
from estimator.session import Array, CalibrationSession

BINS = 24
"""Points of a picture: fewer hide a third harmonic, more are noise."""
ANGLES = ("δβ", "δα")
"""Angles of the head, rad, as which an effect on the applied vector is drawn."""
BETA, TEMPERATURE, TIME, INPUT = "β", "(T − T̄)", "(t − t̄)", "a"
"""Variables over which a picture is drawn: rad, K, s, and the input as a part of the applied vector."""


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
    """(R,) variance of the readings, (m/s²)² ((rad/s)²)."""


def pictures(findings: Sequence[GroupFinding], sessions: Sequence[CalibrationSession]) -> list[Picture | None]:
    """One a finding; None where the sessions are not at hand or show nothing of it."""
    whole = [WhitenedResiduals.of(baseline_of(averaged(s))) for s in sessions] if findings else []
    return [_picture_of(finding, whole) for finding in findings]


def _picture_of(finding: GroupFinding, whole: Sequence[WhitenedResiduals]) -> Picture | None:
    parts: list[Pictured] = []
    variable, subject = variable_of(finding), ""
    for residuals in whole:
        baseline, session = residuals.baseline, residuals.baseline.session
        added = added_by(baseline, [fixed(finding)], ()) if finding.subject in session.subjects else None
        if added is None:
            continue
        effect = added.columns @ added.amplitude
        left = left_without(residuals, effect)
        subject = subject or (finding.sensors[0] if finding.sensors else leading_angle(baseline, effect))
        parts += list(drawn(baseline, left, subject, variable))
    return pooled_picture(parts, variable, subject) if parts else None


def drawn(baseline: Baseline, left: Array, subject: str, variable: str) -> Iterator[Pictured]:
    """One session: of a sensor by its name, of every one that `EVERY` means, or of an angle; ``left`` (R, m)."""
    if subject in ANGLES:
        before, variance = seen_as_angle(baseline, baseline.residual, subject)
        after, _ = seen_as_angle(baseline, left, subject)
        yield Pictured(values_of(baseline, 0, variable), before, after, variance)
        return
    for i, sensor in enumerate(baseline.session.sensors):
        if subject in (sensor.name, EVERY):
            at = values_of(baseline, i, variable)
            yield Pictured(at, baseline.residual[:, i], left[:, i], variance_of(baseline, i))


def slopes(baseline: Baseline, angle: str) -> Array | None:
    """(R, m) change of the inputs, m/s² (rad/s) per rad of an angle of the head; None without a stand."""
    turn = baseline.setting.d_beta if angle == "δβ" else baseline.setting.d_alpha
    return None if turn is None else baseline.setting.through(turn[..., None])[..., 0]


def leading_angle(baseline: Baseline, effect: Array) -> str:
    """The angle that an effect (R, m) on the applied vector turns most; none without a stand."""
    best = {}
    for angle in ANGLES:
        slope = slopes(baseline, angle)
        if slope is not None:
            best[angle] = float((((slope * effect).sum(axis=1)) ** 2 / (slope**2).sum(axis=1)).sum())
    return max(best, key=lambda angle: best[angle]) if best else baseline.session.sensors[0].name


def seen_as_angle(baseline: Baseline, residual: Array, angle: str) -> tuple[Array, Array]:
    """(R,) rad and its variance: the angle that the residuals (R, m) of a row look like."""
    slope = slopes(baseline, angle)
    assert slope is not None
    weight = 1 / baseline.variance
    size = (slope**2 * weight).sum(axis=1)
    angle_sigma = float(baseline.session.stand.sigma.beta) if baseline.session.stand and angle == "δβ" else 0.0
    return (slope * residual * weight).sum(axis=1) / size, 1 / size + angle_sigma**2


def variable_of(finding: GroupFinding) -> str:
    """The variable that an effect depends on most clearly."""
    known = cause(finding.cause)
    if "temperature" in known.needs:
        return TEMPERATURE
    if "time" in known.needs:
        return TIME
    return INPUT if finding.sensors else BETA


def pooled_picture(parts: Sequence[Pictured], variable: str, subject: str) -> Picture:
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
    return Picture(
        variable=variable,
        at=tuple(((edges[1:] + edges[:-1]) / 2)[seen].tolist()),
        before=tuple(mean[0].tolist()),
        after=tuple(mean[1].tolist()),
        sigma=tuple((total[seen] ** -0.5).tolist()),
        of=subject,
    )


def left_without(residuals: WhitenedResiduals, effect: Array) -> Array:
    """(R, m) m/s² (rad/s): what the calibration leaves once an effect (R, m) is taken out."""
    step = residuals.response @ residuals.whitened(effect[..., None])[:, 0]
    baseline = residuals.baseline
    absorbed = (baseline.design * step.reshape(effect.shape[1], 5)).sum(axis=-1)
    return np.asarray(baseline.residual - (effect - absorbed))


def variance_of(baseline: Baseline, i: int) -> Array:
    """(R,) variance of a sensor's readings with the stand's errors of each row, (m/s²)² ((rad/s)²)."""
    sigma = np.where(np.isfinite(baseline.row_sigma), baseline.row_sigma, 0.0)
    return np.asarray(baseline.variance[:, i] + ((baseline.row[:, i] * sigma) ** 2).sum(axis=-1))


def values_of(baseline: Baseline, i: int, variable: str) -> Array:
    """(R,) values of the variable of a picture; the input of the sensor where the session lacks it."""
    setting = baseline.setting
    if variable == TIME and setting.time is not None:
        return setting.time - setting.time.mean()
    if variable in (TEMPERATURE, "dT/dt") and setting.temperature is not None:
        return setting.temperature - setting.temperature.mean()
    if variable == BETA and setting.beta is not None:
        return np.mod(setting.beta, 2 * np.pi)
    return setting.a[:, i] / setting.norm[i]
