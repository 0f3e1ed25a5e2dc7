"""Missing positions, plans and readiness in words."""

from collections.abc import Callable
from itertools import groupby

import numpy as np

from estimator.causes import CATALOGUE
from estimator.message import joined, say, say_count
from estimator.planning import JudgedParameter, Missing, Plan
from estimator.readiness import Disturbance, DriftOutlook, Readiness, ReadinessState
from estimator.readiness.faults import FaultKind, RecordFault
from estimator.readiness.results import DisturbanceKind
from estimator.results import PARAMETERS
from estimator.session import GYROSCOPE
from service.diagnosis.words.diagnosis import BlindCauses, SeenCause, blind_causes, seen_causes
from service.kit.measures import ARCSEC, MEASURES, MINUS, THIN, deviation_measure, in_measure, number

MOST = 12
"""Angles that are listed; the rest are counted."""


def missing_in_words(found: Missing) -> tuple[str, ...]:
    """A sentence on progress, then one a run or a line a direction, then the parameters that are open until then."""
    if found.is_complete:
        return (say("Complete: {done} positions, and every parameter is observed.", done=found.done),)
    done = found.done
    lines: list[str] = [
        say_count(
            "{n} position is done, {remaining} still to come.",
            "{n} positions are done, {remaining} still to come.",
            done,
            remaining=len(found.settings) or len(found.directions),
        )
    ]
    for run, settings in groupby(found.settings, key=lambda setting: setting[0]):
        angles = [f"{number(float(np.degrees(beta)), 2).rstrip('0').rstrip('.')}°" for _, beta in settings]
        rest = say(" and {number} more", number=len(angles) - MOST) if len(angles) > MOST else ""
        lines.append(say("{run}: β = {angles}{rest}", run=run, angles=", ".join(angles[:MOST]), rest=rest))
    lines += [
        say("up along {direction} in block axes", direction=_vector(direction))
        for direction in found.directions.tolist()
    ]
    if found.unseen:
        unseen, is_more = joined(", ", found.unseen[:MOST]), len(found.unseen) > MOST
        template = "Not determined yet: {unseen} …." if is_more else "Not determined yet: {unseen}."
        lines.append(say(template, unseen=unseen))
    return tuple(lines)


def _vector(direction: list[float]) -> str:
    return f"({', '.join(f'{part:.2f}'.replace('-', MINUS) for part in direction)})"


VERDICTS = {
    "enough": "enough: U is within the requested share of the tolerance",
    "usable": "usable: U is within the tolerance, but larger than the requested share",
    "undecidable": "undecidable: U exceeds the tolerance, or nothing is observed",
    "not judged": "no tolerance was given",
}
"""Meanings of the verdicts of a plan."""
UNSEEN = "not observable"
OF_GYROS = frozenset(cause.identifier for cause in CATALOGUE if cause.kind == GYROSCOPE)
"""Causes that an accelerometer cannot have."""


def seen(plan: Plan) -> tuple[SeenCause, ...]:
    """Causes that the plan would find, with the smallest size."""
    return seen_causes(plan.limits, {sensor.kind for sensor in plan.schedule.sensors})


def blind(plan: Plan) -> tuple[BlindCauses, ...]:
    """Causes that the plan cannot see; those of gyros are left out where there are none."""
    has_gyros = any(s.kind == GYROSCOPE for s in plan.schedule.sensors)
    return blind_causes([limit for limit in plan.limits if has_gyros or limit.cause not in OF_GYROS])


def unobserved(plan: Plan) -> str:
    """``scale and axis of every sensor; bias of A2``: parameters that the plan does not observe; empty without any."""
    sensors: dict[tuple[str, ...], list[str]] = {}
    for name in PARAMETERS:
        missing = tuple(j.sensor for j in plan.judged if j.parameter == name and j.sigma is None)
        if missing:
            sensors.setdefault(missing, []).append(name)
    everyone = tuple(s.name for s in plan.schedule.sensors)
    return joined(
        "; ",
        (
            say(
                "{parameters} of {missing}",
                parameters=joined(" and ", parameters),
                missing="every sensor" if missing == everyone else joined(", ", missing),
            )
            for missing, parameters in sensors.items()
        ),
    )


def sigma_in_words(judged: JudgedParameter, coverage: float) -> str:
    """``±2.1 µg``: the expanded uncertainty."""
    if judged.sigma is None:
        return UNSEEN
    measure = MEASURES[judged.kind, judged.parameter]
    return f"±{number(float(f'{coverage * judged.sigma * measure.factor:.2g}'))}{THIN}" + measure.label


def tolerance_in_words(judged: JudgedParameter) -> str:
    """``of 50 µg``, empty where none was given."""
    if judged.tolerance is None:
        return ""
    measure = MEASURES[judged.kind, judged.parameter]
    parts = {"tolerance": number(in_measure(judged.tolerance, measure)), "thin_space": THIN, "label": measure.label}
    return say("of {tolerance}{thin_space}{label}", **parts)


def duration(seconds: float) -> str:
    """``1 h 36 min``."""
    minutes = round(seconds / 60)
    hours, rest = divmod(minutes, 60)
    return say("{hours} h {rest} min", hours=hours, rest=rest) if hours else say("{rest} min", rest=rest)


def headline(plan: Plan) -> str:
    """Summary of the plan in a sentence."""
    size = (
        say("{positions} positions in both runs", positions=plan.positions)
        if len(plan.request.runs) == 2
        else say("{positions} positions in one run", positions=plan.positions)
    )
    if plan.reached is None:
        return say("{size}, {seconds}: no tolerance was given to judge by.", size=size, seconds=duration(plan.seconds))
    if plan.reached:
        return say("{size}, {seconds}, reach every tolerance.", size=size, seconds=duration(plan.seconds))
    short = [j for j in plan.judged if j.verdict in ("usable", "undecidable")]
    names = joined(", ", dict.fromkeys(j.parameter for j in short))
    parts = {"size": size, "seconds": duration(plan.seconds), "names": names}
    return say("{size}, {seconds}, do not reach the tolerance of {names}.", **parts)


MINUTE = 60.0
"""Seconds in a minute."""
FEW = 3
"""Sensors that are named; the others are counted."""


def readiness_headline(found: Readiness) -> str:
    """The headline, to be read across the room."""
    match found.state:
        case ReadinessState.READY:
            return "Ready"
        case ReadinessState.NOT_WARM if found.wait is not None:
            return say("Wait about {wait} minutes", wait=minutes(found.wait[1]))
        case ReadinessState.NOT_WARM:
            return "Not warm: waiting is not enough"
        case ReadinessState.NOT_STILL:
            return say("Not still: {found}", found=_short(found))
        case ReadinessState.TOO_EARLY if found.needed is not None:
            return say("Too early to decide: record about {needed} minutes more", needed=minutes(found.needed))
        case ReadinessState.TOO_EARLY:
            return "Cannot be decided: the sensors wander"
    return "This record cannot be used"


def reasons(found: Readiness, kind: str) -> tuple[str, ...]:
    """Reasons and advice, the most important first."""
    lines = [fault_in_words(fault) for fault in found.faults]
    lines += [disturbance_in_words(event, kind) for event in found.disturbances]
    if found.worst is not None:
        lines += _drift_sentences(found, found.worst)
    return tuple(lines)


def minutes(seconds: float) -> str:
    """Whole minutes, at least one."""
    return number(max(1.0, float(f"{seconds / MINUTE:.2g}")), 0)


def amount(kind: str, value: float) -> str:
    """``12 µg``: of drift."""
    measure = deviation_measure(kind, "bias", abs(value))
    return f"{number(float(f'{value * measure.factor:.2g}'))}{THIN}" + measure.label


def clock(seconds: float) -> str:
    """``3:20``, minutes and seconds into the record."""
    whole = round(seconds)
    return f"{whole // 60}:{whole % 60:02d}"


def named(sensors: tuple[str, ...]) -> str:
    """``A1, A2, A3 and 3 more``."""
    rest = len(sensors) - FEW
    return joined(", ", sensors[:FEW]) + (say(" and {rest} more", rest=rest) if rest > 0 else "")


def _drift_sentences(found: Readiness, worst: DriftOutlook) -> list[str]:
    length = minutes(found.duration)
    bound, allowed = amount(worst.kind, worst.bound), amount(worst.kind, worst.allowed)
    source = (
        "a quarter of the tolerance of its scale factor"
        if worst.limit == "scale"
        else "a quarter of the tolerance of its bias"
    )
    parts = {"length": length, "bound": bound, "name": worst.name, "tolerance": allowed, "source": source}
    if found.state is ReadinessState.READY:
        return [
            say(
                "No sensor exceeds its drift limit in the {length} minutes of the programme: the largest is {bound} "
                "of {name}, with 95 % probability; limit {tolerance}, {source}.",
                **parts,
            )
        ]
    sentences: list[str] = [
        say(
            "{name} may still drift by {bound} in the {length} minutes of the programme (95 %); "
            "limit {tolerance}, {source}.",
            **parts,
        )
    ]
    if found.state is ReadinessState.NOT_WARM:
        return [*sentences, *_waiting_advice(found)]
    if found.state is ReadinessState.TOO_EARLY:
        return [*sentences, *_record_advice(found, worst)]
    return sentences


def _waiting_advice(found: Readiness) -> list[str]:
    if found.wait is None:
        return [
            "It drifts or wanders and does not settle within eight hours: find the cause, such as a draught, the sun "
            "or a loose fixture, or plan a shorter programme."
        ]
    low, middle, high = found.wait
    until = (
        say("up to {high} minutes", high=minutes(high)) if high < float("inf") else "the longest time is not known yet"
    )
    return [
        say(
            "It is settling: wait about {middle} minutes more (at least {low}, {until}), then check again with a new "
            "record.",
            middle=minutes(middle),
            low=minutes(low),
            until=until,
        )
    ]


def _record_advice(found: Readiness, worst: DriftOutlook) -> list[str]:
    if found.needed is not None:
        return [
            say(
                "The record is too short: leave the unit as it is and record about {needed} minutes more.",
                needed=minutes(found.needed),
            )
        ]
    return [
        say(
            "A longer record does not help: {name} wanders by {kind} during the programme. Plan a shorter programme, "
            "or have the sensor checked.",
            name=worst.name,
            kind=amount(worst.kind, worst.wander),
        )
    ]


def _short(found: Readiness) -> str:
    first = next(disturbance for disturbance in found.disturbances if not disturbance.passed)
    return SHORT[first.kind](first)


SHORT: dict[DisturbanceKind, Callable[[Disturbance], str]] = {
    DisturbanceKind.STEP: lambda d: say("somebody touched it at {start}", start=clock(d.start)),
    DisturbanceKind.BURST: lambda d: say("it vibrated at {start}", start=clock(d.start)),
    DisturbanceKind.SHAKING: lambda _: "it vibrates continuously",
    DisturbanceKind.CLIPPED: lambda d: say("{sensors} at the end of the range", sensors=named(d.sensors)),
    DisturbanceKind.CREEP: lambda _: "the fixture creeps",
}
"""Disturbances in a few words."""


def disturbance_in_words(event: Disturbance, kind: str) -> str:
    """Kind, time, sensors and consequence of a disturbance, with advice."""
    sensors, size = named(event.sensors), amount(kind, event.size)
    consequence = "; only the record after it is judged." if event.passed else ". Do not touch it, and record again."
    parts = {"size": size, "start": clock(event.start), "stop": clock(event.stop), "consequence": consequence}
    match event.kind:
        case DisturbanceKind.STEP:
            return say(
                "{sensors} changed by {size} between {start} and {stop}: somebody touched it{consequence}",
                sensors=sensors,
                **parts,
            )
        case DisturbanceKind.BURST:
            return say("{who} vibrated by {size} rms from {start} to {stop}{consequence}", who=sensors, **parts)
        case DisturbanceKind.SHAKING:
            return say(
                "{who}: continuous vibration of {size} rms. With a quadratic term within its tolerance it shifts the "
                "bias by more than the drift limit. Find the source, or isolate the stand from it.",
                who=sensors,
                size=size,
            )
        case DisturbanceKind.CLIPPED:
            share = number(float(f"{100 * event.size:.2g}"))
            return say(
                "{who} is at the end of its range for {share} % of the samples: set a larger range, or stop the "
                "vibration.",
                who=sensors,
                share=share,
            )
    turn = number(float(f"{event.size * ARCSEC.factor:.2g}"))
    return say(
        "All accelerometers drift as if the block turned by {turn} arcsec during the programme: the fixture creeps. "
        "Tighten the mounting, let the stand's locks settle, and record again.",
        turn=turn,
    )


def fault_in_words(fault: RecordFault) -> str:
    """The fault of a record, with advice."""
    sensors = named(fault.sensors)
    match fault.kind:
        case FaultKind.NO_TIME:
            return "The rows have no times: add time_s, or sample_rate_hz for a raw log."
        case FaultKind.CLOCK_BACK:
            return say(
                "The clock goes back at row {amount}: it was restarted. Record again, or cut the file there.",
                amount=f"{fault.amount:.0f}",
            )
        case FaultKind.CLOCK_STANDS:
            return "The clock stands still over most rows: check time_s."
        case FaultKind.NOT_FINITE:
            return say("A reading in row {amount} is not a number: remove the row.", amount=f"{fault.amount:.0f}")
        case FaultKind.FEW:
            return say(
                "{amount} readings are too few to separate drift from noise: record at least twelve in one position.",
                amount=f"{fault.amount:.0f}",
            )
        case FaultKind.POSITIONS:
            return say(
                "The rows are in {amount} positions: leave the block in one and read it repeatedly.",
                amount=f"{fault.amount:.0f}",
            )
        case FaultKind.STUCK:
            return say("Constant reading: {who}. The channel is dead; check power and cables.", who=sensors)
        case FaultKind.COARSE:
            return say(
                "The resolution of the readings is coarser than the drift limit: {who}. Average more samples, with "
                "more digits.",
                who=sensors,
            )
        case FaultKind.UNITS:
            return say(
                "At rest the accelerometers should show 1 g and show {amount} g: check nominal_scale, "
                "nominal_offset and reading_unit.",
                amount=number(float(f"{fault.amount:.3g}")),
            )
        case FaultKind.TURNING:
            return say(
                "The block turns, or the units are wrong: {name}. Let it rest, or check nominal_scale.", name=sensors
            )
        case FaultKind.NOT_JUDGED:
            return "No tolerance limits the drift of these sensors: give one."
        case FaultKind.GAP:
            return say(
                "There is a gap of {amount} minutes in the record; it is judged nevertheless.",
                amount=minutes(fault.amount),
            )
    return say("{who} is the only sensor: creep of the fixture cannot be separated from its drift.", who=sensors)
