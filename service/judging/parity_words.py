"""A recording in service in words: its agreement with the calibration, and the changes that it cannot show."""

from collections.abc import Iterator

from estimator.message import capitalised, joined, say
from estimator.parity import ParityResult
from estimator.parity.results import FULL_SCALE, STUCK, ZERO
from service.judging.words import (
    CHANGED,
    MOST_CANDIDATES,
    SAME,
    TOO_MUCH_MOTION,
    clipped_in_words,
    found_in_words,
    stillness,
    within,
)
from service.kit.measures import number
from service.sessions.words.readings import FitWords

COMMON = (
    "a common change of bias that an acceleration explains, a common turn of all axes, a common change of all scale "
    "factors, or any stretch or shear of the axes"
)
"""Changes that the sensors' disagreement cannot show: any motion, and any linear map of it, explains them."""
ONE_ORIENTATION = (
    "The recording has too little rotation to separate a change of bias from one of scale factor or axis: record slow "
    "turns as well."
)
SMALLEST = 1e-4
"""Probability below which its size says no more."""
SILENT = (STUCK, ZERO, FULL_SCALE)
"""Kinds of fault of a silent sensor; where too few others are left, it still stands in the part after."""
PER_SENSOR = 4
"""Numbers of a sensor that can change: scale, bias and two turns of its axis."""


def agreement_in_words(result: ParityResult) -> FitWords:
    """The agreement of the recording with the calibration, with warnings."""
    chance = "less than 0.01" if result.p_value < SMALLEST else number(100 * result.p_value, 1)
    quiet = TOO_MUCH_MOTION if result.moving else SAME
    return FitWords(
        headline=say("{result}.", result=CHANGED if result.detected or result.faults else quiet),
        detail=say(
            "χ² = {chi2} for {dof} numbers; an unchanged block gives this much or more in {chance} % of recordings.",
            chi2=number(result.chi2, 1),
            dof=result.dof,
            chance=chance,
        ),
        warnings=tuple(_warnings(result)),
    )


def parts_in_words(result: ParityResult) -> tuple[str, ...]:
    """The results of parity for the part before a sensor fails, and for the part after; none where none fails."""
    if not result.faults:
        return ()
    kept = {sensor.name for sensor in result.after.sensors} if result.after is not None else set()
    left_out = joined(", ", (sensor.name for sensor in result.sensors if sensor.name not in kept))
    is_blind = any(fault.kind in SILENT and fault.sensor in kept for fault in result.faults)
    after = None if is_blind else result.after
    without = say(", without {sensors}", sensors=left_out) if after is not None and left_out else ""
    lines = (
        say("Before that: {found}.", found=_of_part(result.before, "no change since the calibration")),
        say(
            "From then on{without}: {found}.",
            without=without,
            found=_of_part(after, "nothing else has changed since the calibration"),
        ),
    )
    return lines if result.faults[0].since > 0 else lines[1:]


def _of_part(part: ParityResult | None, quiet: str) -> str:
    """``quiet`` where nothing was found."""
    if part is None:
        return "too little to be judged"
    return within(found_in_words(part)) if part.detected or part.moving else quiet


def _warnings(result: ParityResult) -> Iterator[str]:
    can = PER_SENSOR * len(result.sensors)
    parts = {"dof": result.dof, "total": can, "common": COMMON}
    yield say("Parity observes {dof} of {total} parameters. It cannot observe {common}.", **parts)
    if not result.complete:
        yield ONE_ORIENTATION
    if result.moving:
        yield _suspicion(result)
    yield from (say("{clipped}.", clipped=clipped_in_words(result, name)) for name in result.clipped)
    left = [
        say("{count} {reason}", count=count, reason=_why(reason, result))
        for reason, count in result.left_out.items()
        if count
    ]
    if left:
        yield say("Excluded, of {blocks} blocks: {left}.", blocks=result.blocks, left=joined(", ", left))


def _suspicion(result: ParityResult) -> str:
    suspects = list(dict.fromkeys(c.sensor for c in result.suspects))[:MOST_CANDIDATES]
    act = stillness(result)
    return say(
        "If motion had no effect on sound sensors, χ² would be {chi2_unmoved} for {dof} numbers and {suspects} would "
        "be suspected. {act}.",
        chi2_unmoved=number(result.chi2_unmoved, 1),
        dof=result.dof,
        suspects=joined(" or ", suspects),
        act=capitalised(act),
    )


def _why(reason: str, result: ParityResult) -> str:
    if reason == "saturated":
        return say("in which {saturated} was at the end of the range", saturated=joined(", ", result.saturated))
    return "in which the block moved, because its sensors are not at one point"
