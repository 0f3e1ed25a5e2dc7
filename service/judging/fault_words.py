"""A sensor that fails within a recording in service, in words: the fault, its start, its size and the remedy."""

from datetime import timedelta

from estimator.message import Message, capitalised, joined, say
from estimator.moments import local_moment
from estimator.parity import CourseFault, ParityResult
from estimator.parity.results import (
    DELAY,
    EXCHANGED,
    FULL_SCALE,
    GAIN,
    INTERMITTENT,
    NOISE,
    RAMP,
    STEP,
    STUCK,
    ZERO,
)
from service.kit.measures import COVERAGE, HARD, Measure, day_of, deviation_measure, measured, number, signed
from service.sessions.decision import ServiceFault

DOES = {
    STEP: "the bias of {who} has been off{by} {when}",
    RAMP: "the bias of {who} has been drifting{by} {when}",
    STUCK: "{who} has stood still {when}",
    ZERO: "{who} has read zero {when}",
    FULL_SCALE: "{who} has stood at the end of its range {when}",
    GAIN: "the scale factor of {who} has been off{by} {when}",
    NOISE: "{who} has been too noisy{by} {when}",
    DELAY: "the readings of {who} have come late{by} {when}",
    EXCHANGED: "{who} have been exchanged {when}",
    INTERMITTENT: "{who} has been off now and then{by} {when}",
}
REPAIR = "replace or repair {who}"
REPAIR_CHANNEL = "replace or repair {who}, and check its channel and its plug"
REMEDIES = {
    STUCK: REPAIR_CHANNEL,
    ZERO: REPAIR_CHANNEL,
    FULL_SCALE: REPAIR_CHANNEL,
    NOISE: "check the mounting and the supply of {who}; replace it if both are sound",
    DELAY: "check the filter and the sampling of the channel of {who}",
    EXCHANGED: "check the wiring and the columns of {who}, and upload the recording again corrected",
    INTERMITTENT: "check the connector of {who}",
}
"""Remedies by kind of fault; for the other kinds the sensor is replaced or repaired."""
FIND = "calibrate the unit to find the sensor, and replace or repair it"
SIZED = (STEP, RAMP, GAIN, NOISE, DELAY, INTERMITTENT)
"""Kinds whose size says something: a channel that stands still or is exchanged is off by anything."""
MILLISECONDS = Measure("ms", 1e3)


def faults_in_words(result: ParityResult, started_at: str | None) -> tuple[ServiceFault, ...]:
    """Every sensor that fails, the earliest first; ``started_at`` by the clock of the place, None where the file does
    not say."""
    return tuple(_in_words(fault, result, started_at) for fault in result.faults)


def _in_words(fault: CourseFault, result: ParityResult, started_at: str | None) -> ServiceFault:
    is_named = fault.sensor is not None or fault.kind == EXCHANGED
    names = [sensor.name for sensor in result.sensors if sensor.name in fault.suspects]
    who = joined(" and ", names)
    does = say(
        DOES[fault.kind],
        who=who if is_named else say("one of the sensors {names}", names=joined(", ", names)),
        by=_by(fault, result.kind) if fault.kind in SIZED else "",
        when=_when(fault, result, started_at),
    )
    unnamed = say("{what}; the redundancy is too small to say which", what=does)
    return ServiceFault(
        sensors=fault.suspects,
        place=fault.suspects[0] if len(fault.suspects) == 1 else "",
        what=does if is_named else unnamed,
        remedy=say(REMEDIES.get(fault.kind, REPAIR), who=who) if is_named else say(FIND),
    )


def _by(fault: CourseFault, kind: str) -> str:
    """`` by +100.2 ± 0.4 mg``, with U; empty where the size cannot be told."""
    if fault.size is None:
        return ""
    expanded = None if fault.sigma is None else COVERAGE * fault.sigma
    if fault.kind == DELAY:
        return say(" by {size}", size=measured(fault.size, expanded, MILLISECONDS))
    if fault.kind == GAIN:
        return say(" by {size}", size=signed(fault.size, expanded, deviation_measure(kind, "scale", fault.size)))
    if fault.kind == RAMP:
        a_second = deviation_measure(kind, "bias", 60 * fault.size)
        a_minute = Measure(say("{label} per minute", label=a_second.label), 60 * a_second.factor)
        return say(" by {size}", size=signed(fault.size, expanded, a_minute))
    measure = deviation_measure(kind, "bias", fault.size)
    if fault.kind == NOISE:
        return say(", with {size} a sample,", size=measured(fault.size, expanded, measure))
    return say(" by {size}", size=signed(fault.size, expanded, measure))


def _when(fault: CourseFault, result: ParityResult, started_at: str | None) -> str:
    begins = _moment(fault.since, fault.since_sigma, result, started_at)
    if fault.until is not None:
        ends = _moment(fault.until, fault.since_sigma, result, started_at)
        return say("from {begins} to {ends}", begins=begins, ends=ends)
    return say("since {begins}", begins=begins) if fault.since > 0 else say("throughout the recording")


def _moment(at: float, sigma: float, result: ParityResult, started_at: str | None) -> str:
    """``12:04:10 UTC (120 s into the recording)``; to the second, with U where that is more, and the day where it is
    another than that of the start."""
    if result.block_seconds is None:
        return say("row {row} of the recording", row=int(at) + 1)
    spread = int(COVERAGE * sigma)
    seconds = f"{number(at, 0)}{HARD}±{HARD}{number(spread, 0)}" if spread else number(at, 0)
    into = say("{seconds} s into the recording", seconds=seconds)
    if started_at is None:
        return into
    start = local_moment(started_at)
    clock = start + timedelta(seconds=at)
    day = "" if clock.date() == start.date() else say(" on {day}", day=day_of(clock))
    zone = clock.isoformat()[-6:] if clock.utcoffset() else "UTC"
    return say("{time} {zone}{day} ({into})", time=f"{clock:%H:%M:%S}", zone=zone, day=day, into=into)


def said_of(faults: tuple[ServiceFault, ...]) -> str:
    """All in sentences; ``remedy`` of its parts is that of the first."""
    first, *others = faults
    more = joined("", (say(" {sentence}", sentence=fault.sentence) for fault in others))
    return say("{what}: {remedy}.{more}", what=capitalised(first.what), remedy=first.remedy, more=more)


def remedy_in(reason: str) -> str:
    """The remedy in the reason of a verdict; empty where it states none."""
    if not isinstance(reason, Message):
        return ""
    inside = (remedy_in(part) for part in reason.parts.values())
    return reason.parts.get("remedy") or next(filter(None, inside), "")
