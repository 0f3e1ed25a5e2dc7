"""Whether a unit is ready to be measured, in words: one sentence, and then the reasons."""

from collections.abc import Callable

from estimator.readiness import Disturbance, Outlook, Readiness, State
from estimator.readiness.faults import Fault, FaultKind
from estimator.readiness.results import Kind
from service.kit.measures import ARCSEC, THIN, deviation_measure, number

MINUTE = 60.0
"""s."""
FEW = 3
"""Sensors that are named; the others are counted."""


def headline(found: Readiness) -> str:
    """The one sentence that is read across the room."""
    match found.state:
        case State.READY:
            return "Ready"
        case State.NOT_WARM if found.wait is not None:
            return f"Wait about {minutes(found.wait[1])} minutes"
        case State.NOT_WARM:
            return "Not warm: waiting alone will not do"
        case State.NOT_STILL:
            return f"Not still: {_short(found)}"
        case State.TOO_EARLY if found.needed is not None:
            return f"Too early to tell: record about {minutes(found.needed)} minutes more"
        case State.TOO_EARLY:
            return "Not to be told: the sensors wander"
    return "Nothing can be told from this record"


def reasons(found: Readiness, kind: str) -> tuple[str, ...]:
    """Why, and what to do, in order of weight."""
    lines = [fault_in_words(fault) for fault in found.faults]
    lines += [disturbance_in_words(one, kind) for one in found.disturbances]
    if found.worst is not None:
        lines += _of_drift(found, found.worst)
    return tuple(lines)


def minutes(seconds: float) -> str:
    """Whole minutes, never none."""
    return number(max(1.0, float(f"{seconds / MINUTE:.2g}")), 0)


def amount(kind: str, value: float) -> str:
    """``12 µg``: of drift."""
    measure = deviation_measure(kind, "bias", abs(value))
    return f"{number(float(f'{value * measure.factor:.2g}'))}{THIN}{measure.label}"


def clock(seconds: float) -> str:
    """``3:20``, minutes and seconds into the record."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


def named(sensors: tuple[str, ...]) -> str:
    """``A1, A2, A3 and 3 more``."""
    rest = len(sensors) - FEW
    return ", ".join(sensors[:FEW]) + (f" and {rest} more" if rest > 0 else "")


def _of_drift(found: Readiness, worst: Outlook) -> list[str]:
    length = minutes(found.duration)
    bound, allowed = amount(worst.kind, worst.bound), amount(worst.kind, worst.allowed)
    by = f"a quarter of the tolerance of its {'scale factor' if worst.limit == 'scale' else 'bias'}"
    if found.state is State.READY:
        return [
            f"No sensor will drift by more than it may in the {length} minutes of the programme: the most is {bound} "
            f"of {worst.name}, with 95 % probability; allowed are {allowed}, {by}."
        ]
    said = [
        f"{worst.name} may still drift by {bound} in the {length} minutes of the programme (95 %); allowed are "
        f"{allowed}, {by}."
    ]
    if found.state is State.NOT_WARM:
        return [*said, *_of_waiting(found)]
    if found.state is State.TOO_EARLY:
        return [*said, *_of_telling(found, worst)]
    return said


def _of_waiting(found: Readiness) -> list[str]:
    if found.wait is None:
        return [
            "It drifts steadily or wanders, and does not settle within eight hours: look for the cause, such as a "
            "draught, the sun or a loose fixture, or plan a shorter programme."
        ]
    low, middle, high = found.wait
    until = f"up to {minutes(high)} minutes" if high < float("inf") else "how long at most cannot be told yet"
    return [
        f"It settles: wait about {minutes(middle)} minutes more (at least {minutes(low)}, {until}), and ask again with "
        "a new record."
    ]


def _of_telling(found: Readiness, worst: Outlook) -> list[str]:
    if found.needed is not None:
        return [
            "The record is too short to tell: leave the unit as it is and record about "
            f"{minutes(found.needed)} minutes more."
        ]
    return [
        f"No length of record would tell: {worst.name} wanders by {amount(worst.kind, worst.wander)} in the time of "
        "the programme by itself. Plan a shorter programme, or have the sensor looked at."
    ]


def _short(found: Readiness) -> str:
    one = next(own for own in found.disturbances if not own.passed)
    return SHORT[one.kind](one)


SHORT: dict[Kind, Callable[[Disturbance], str]] = {
    Kind.STEP: lambda one: f"somebody touched it at {clock(one.start)}",
    Kind.BURST: lambda one: f"it shook at {clock(one.start)}",
    Kind.SHAKING: lambda one: "it shakes all the time",
    Kind.CLIPPED: lambda one: f"{named(one.sensors)} at the end of the range",
    Kind.CREEP: lambda one: "the fixture creeps",
}
"""What disturbs, in a few words."""


def disturbance_in_words(one: Disturbance, kind: str) -> str:
    """What happened, when, to whom, and what to do."""
    who, size = named(one.sensors), amount(kind, one.size)
    after = "; what came after it is judged alone." if one.passed else ". Leave it alone and record anew."
    match one.kind:
        case Kind.STEP:
            return (
                f"{who} changed by {size} between {clock(one.start)} and {clock(one.stop)}: somebody touched it{after}"
            )
        case Kind.BURST:
            return f"{who} shook by {size} rms from {clock(one.start)} to {clock(one.stop)}{after}"
        case Kind.SHAKING:
            return (
                f"{who} shake by {size} rms all the time: a quadratic term within its tolerance would turn that into "
                "more than the drift allowed. Find what vibrates, or decouple the stand from it."
            )
        case Kind.CLIPPED:
            share = number(float(f"{100 * one.size:.2g}"))
            return (
                f"{who} stands at the end of its range for {share} % of the samples: set a larger range, or stop what "
                "vibrates."
            )
    turn = number(float(f"{one.size * ARCSEC.factor:.2g}"))
    return (
        f"All accelerometers drift as if the block turned, by {turn} arcsec over the programme: the fixture creeps. "
        "Tighten the mounting, let the stand's locks settle, and record anew."
    )


def fault_in_words(fault: Fault) -> str:
    """What is wrong with the record, and what to do."""
    who = named(fault.sensors)
    match fault.kind:
        case FaultKind.NO_TIME:
            return "The rows have no times: add time_s, or sample_rate_hz for a raw log."
        case FaultKind.CLOCK_BACK:
            return (
                f"The clock goes back at row {fault.amount:.0f}: it was restarted. Record anew, or cut the file there."
            )
        case FaultKind.CLOCK_STANDS:
            return "The clock stands still over most rows: check time_s."
        case FaultKind.NOT_FINITE:
            return f"Row {fault.amount:.0f} holds a reading that is no number: take the row out."
        case FaultKind.FEW:
            return (
                f"{fault.amount:.0f} readings are too few to tell drift from noise: record at least twelve in one "
                "position."
            )
        case FaultKind.POSITIONS:
            return (
                f"The rows stand in {fault.amount:.0f} positions: leave the block in one, and read it again and again."
            )
        case FaultKind.STUCK:
            return (
                f"One and the same reading throughout: {who}. That is a dead channel and no rest; check power and "
                "cables."
            )
        case FaultKind.COARSE:
            return (
                f"One step of the readings is larger than the drift allowed: {who}. Average more samples, with more "
                "digits."
            )
        case FaultKind.UNITS:
            return (
                f"At rest the accelerometers should show 1 g and show {number(float(f'{fault.amount:.3g}'))} g: check "
                "nominal_scale, nominal_offset and reading_unit."
            )
        case FaultKind.TURNING:
            return f"The block turns, or the units are wrong: {who}. Let it rest, or check nominal_scale."
        case FaultKind.NOT_JUDGED:
            return "No tolerance says how far these sensors may drift: give one."
        case FaultKind.GAP:
            return f"There is a gap of {minutes(fault.amount)} minutes in the record; it is judged all the same."
    return f"{who} is alone: a fixture that creeps cannot be told from a drift of its own."
