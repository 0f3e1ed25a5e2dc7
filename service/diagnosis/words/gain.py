"""Gain from naming causes: one sentence with one number for every sensor."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import floor, isfinite, log10
from statistics import median

from estimator.diagnosis import Finding
from estimator.diagnosis.results import Gain
from estimator.message import joined, say
from service.kit.measures import THIN, decimals, deviation_measure, number

NAMED = 3
"""Most sensors that are named; of the others only the number is given."""
SHARES = (
    (0.22, 0.28, "of {sensor} falls to a quarter: {before} → {after}"),
    (0.30, 0.37, "of {sensor} falls to a third: {before} → {after}"),
    (0.45, 0.55, "of {sensor} halves: {before} → {after}"),
    (0.63, 0.70, "of {sensor} falls by a third: {before} → {after}"),
    (0.72, 0.78, "of {sensor} falls by a quarter: {before} → {after}"),
    (0.98, 1.02, "of {sensor} does not fall: {before} → {after}"),
)
"""Least and largest remaining share of the error, and the sentence for it."""
FALLS = "of {sensor} falls from {before} to {after}"
RISES = "of {sensor} rises from {before} to {after}"


@dataclass(frozen=True)
class HeldOut:
    """Root mean square error of one sensor's readings that took no part in the fit, m/s² (rad/s)."""

    sensor: str
    kind: str
    before: float
    after: float
    typical: float
    """Median error of the sensor's kind, before."""


Errors = Mapping[str, Mapping[str, float]]
"""Root mean square of every sensor, m/s² (rad/s), by kind and name."""


def gain_in_words(gain: Gain, sensors: Sequence[str] = ()) -> str:
    """The gain of sensors, or of all where none is named: ``Held-out error of A2 halves: 14 → 7 µg (readings that took
    no part).``

    Empty where a version that stated none made it, and where the findings leave every reading's prediction as it was: a
    change since earlier sessions is none within the session.
    """
    parts = errors_in_words(gain.before.rms_by_sensor or {}, gain.after.rms_by_sensor or {}, sensors)
    return say("Held-out error {parts} (readings that took no part).", parts=parts) if parts else ""


def errors_in_words(before: Errors, after: Errors, sensors: Sequence[str] = ()) -> str:
    """``of A2 halves: 14 → 7 µg; of A5 falls from 9 to 8 µg``: the worst first, the rest counted; empty without any."""
    known = [held_out for held_out in _errors(before, after) if not sensors or held_out.sensor in sensors]
    worst = sorted(known, key=lambda held_out: -held_out.before / held_out.typical)
    parts = [_of_sensor(held_out) for held_out in worst[:NAMED]]
    if len(worst) > NAMED:
        parts.append(say("and {number} more", number=len(worst) - NAMED))
    return joined("; ", parts) if parts else ""


def concerned(findings: Iterable[Finding]) -> tuple[str, ...]:
    """The sensors that some findings name; none where one of them acts on all."""
    by_finding = [finding.sensors for finding in findings]
    return tuple(dict.fromkeys(sensor for sensors in by_finding for sensor in sensors)) if all(by_finding) else ()


def _errors(before: Errors, after: Errors) -> Iterator[HeldOut]:
    """The errors of every sensor of which both are known, and that the extended model predicts otherwise."""
    for kind, by_sensor in before.items():
        typical = median(by_sensor.values())
        for sensor, error in by_sensor.items():
            since = after.get(kind, {}).get(sensor, 0.0)
            if error > 0 and since > 0 and error != since and isfinite(error) and isfinite(since):
                yield HeldOut(sensor, kind, error, since, typical)


def _of_sensor(held_out: HeldOut) -> str:
    share = held_out.after / held_out.before
    otherwise = FALLS if share < 1 else RISES
    words = next((said for low, high, said in SHARES if low <= share <= high), otherwise)
    measure = deviation_measure(held_out.kind, "bias", max(held_out.before, held_out.after))
    before, after = held_out.before * measure.factor, held_out.after * measure.factor
    digits = max(decimals(before) or 0, -floor(log10(after)))
    return say(
        words, sensor=held_out.sensor, before=number(before, digits), after=number(after, digits) + THIN + measure.label
    )
