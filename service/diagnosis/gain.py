"""Gain from naming the causes, and the parameters that it moved."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from math import isclose, isfinite, nan

import numpy as np

from estimator.diagnosis.results import Gain, Score
from estimator.message import say
from estimator.moments import moment
from estimator.results import Calibration, Estimate, SensorCalibration
from service.kit.measures import deviation_measure, leading_kind, measured, number
from service.sessions.decision import Verdict
from service.sessions.words.conditions import Condition, condition_of

WORTH_A_LINE = 0.02
"""Shift, in the parameter's own standard uncertainties, below which nobody would miss the line."""
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
class MovedParameterLine:
    """Moves of one sensor's parameters because the causes are in the model."""

    sensor: str
    scale: str
    bias: str
    axis: str


@dataclass(frozen=True)
class GainView:
    """The gain of the extended model."""

    held_out: str
    """Readings without part in the fit: ``positions``, ``turns``."""
    is_none: bool
    """Whether the named causes show elsewhere than in the prediction of held-out readings."""
    rows: tuple[GainRow, ...]
    """Scores of the readings of this session without part in the fit."""
    earlier_rows: tuple[GainRow, ...]
    """The earlier session, with the size found in this one; empty where the causes cannot have acted there."""
    earlier_at: datetime | None
    moved: tuple[MovedParameterLine, ...]
    """Sensors of which anything moved."""
    verdict_before: Condition
    verdict_after: Condition | None

    @property
    def shows_nothing(self) -> bool:
        """Whether neither a prediction nor the verdict is another with the causes in the model."""
        return self.is_none and not self.changes_verdict

    @property
    def changes_verdict(self) -> bool:
        """Whether the verdict is another with the causes in the model."""
        return self.verdict_after not in (None, self.verdict_before)


def gain_view(
    gain: Gain, before: Calibration, after: Calibration, verdict: Verdict, verdict_after: Verdict | None
) -> GainView:
    """Before is the calibration in force, after the one with the named causes; each with its verdict."""
    earlier, kinds = gain.session, _kinds(gain, after)
    return GainView(
        held_out=gain.held_out,
        is_none=_is_same(gain.before, gain.after),
        rows=_rows(gain.before, gain.after, kinds),
        earlier_rows=() if earlier is None else _rows(earlier.before, earlier.after, kinds),
        earlier_at=None if earlier is None else _at(earlier.started_at),
        moved=tuple(
            _moved(a, b)
            for a, b in zip(before.sensors, after.sensors, strict=False)
            if a.name == b.name and _has_moved(a, b)
        ),
        verdict_before=condition_of(verdict),
        verdict_after=None if verdict_after is None else condition_of(verdict_after),
    )


def _kinds(gain: Gain, calibration: Calibration) -> tuple[str, ...]:
    """Kinds of sensor whose error of prediction is stated: of earlier versions the leading one alone."""
    kinds = {sensor.kind for sensor in calibration.sensors}
    leading = leading_kind(kinds)
    others = sorted(kinds & set(gain.after.rms_by_kind) - {leading})
    return leading, *others


def _at(started_at: str | None) -> datetime | None:
    """The start of a session; None where its file does not state it."""
    return None if started_at is None else moment(started_at)


def _is_same(before: Score, after: Score) -> bool:
    return all(isclose(a, b, rel_tol=SAME) for a, b in zip(_numbers(before), _numbers(after), strict=False))


def _numbers(score: Score) -> tuple[float, ...]:
    return score.rms, score.chi2_per_dof, score.log_score, *score.rms_by_kind.values()


def _rows(before: Score, after: Score, kinds: Sequence[str]) -> tuple[GainRow, ...]:
    """One line of rms for every kind of sensor, each in its own unit, then what holds of all."""
    chi2 = (number(score.chi2_per_dof, 3) for score in (before, after))
    log_score = (number(score.log_score, 3) for score in (before, after))
    return (
        *(_rms(before, after, kind, several=len(kinds) > 1) for kind in kinds),
        GainRow("χ² per degree of freedom", "1 where the noise explains the errors", *chi2),
        GainRow("log score", "of a reading; higher is better", *log_score),
    )


def _rms(before: Score, after: Score, kind: str, *, several: bool) -> GainRow:
    """The error of one kind of sensor; earlier versions stated that of the leading kind alone."""
    rms = tuple(score.rms_by_kind.get(kind, nan if several else score.rms) for score in (before, after))
    measure = deviation_measure(kind, "bias", max((x for x in rms if isfinite(x)), default=0.0))
    who = say(" of {kind}s", kind=kind) if several else ""
    return GainRow(
        "rms",
        say("error of prediction{sensors}, {label}", sensors=who, label=measure.label),
        *(number(x * measure.factor, 3) for x in rms),
    )


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


def _moved(before: SensorCalibration, after: SensorCalibration) -> MovedParameterLine:
    return MovedParameterLine(
        sensor=after.name,
        scale=_relative(before.scale, after.scale, after.kind),
        bias=_change(before.bias, after.bias, after.kind),
        axis=_turned(before, after),
    )


def _relative(before: Estimate, after: Estimate, kind: str) -> str:
    if before.value is None or after.value is None or after.sigma is None:
        return "–"
    change, expanded = after.value / before.value - 1, after.factor() * after.sigma / abs(after.value)
    return measured(change, expanded, deviation_measure(kind, "scale", max(abs(change), expanded)))


def _change(before: Estimate, after: Estimate, kind: str) -> str:
    if before.value is None or after.value is None or after.sigma is None:
        return "–"
    change, expanded = after.value - before.value, after.factor() * after.sigma
    return measured(change, expanded, deviation_measure(kind, "bias", max(abs(change), expanded)))


def _turned(before: SensorCalibration, after: SensorCalibration) -> str:
    if before.axis is None or after.axis is None or after.axis_sigma is None:
        return "–"
    angle = float(np.linalg.norm(np.cross(before.axis, after.axis)))
    expanded = after.factor("axis") * after.axis_sigma
    return measured(angle, expanded, deviation_measure(after.kind, "axis", max(angle, expanded)))
