"""Step: the common motions of a block's sensors since the reference → plain sentences."""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.health.common_motion import AXES, BEYOND, SEPARATED, UNCLEAR, CommonMotion
from estimator.message import joined, say
from estimator.session import ACCELEROMETER
from estimator.wording import few
from service.kit.measures import COARSE_MEASURES, DEGREE, Measure, deviation_measure, measured, number, signed

SIGNIFICANT = 0.01
"""Chance of saying so of a block that did not move."""
JUDGED = "The sensors are judged without this effect."
NEARLY = 0.94
"""Cosine of 20°: a turn this near to an axis of the block is named after it."""


@dataclass(frozen=True)
class MotionLine:
    """One sentence, and whether it asks for attention."""

    tone: str
    text: str


def motions_in_words(
    motions: Sequence[CommonMotion], coverage: float, since: str = "since the reference"
) -> tuple[MotionLine, ...]:
    """One sentence for each quantity with a common motion to report."""
    several = len({motion.kind for motion in motions}) > 1
    kind_words = {motion.kind: say(" of the {kind}s", kind=motion.kind) if several else "" for motion in motions}
    lines = [_line(motion, coverage, kind_words[motion.kind], since) for motion in motions]
    return tuple(line for line in lines if line is not None)


def beyond_in_words(motions: Sequence[CommonMotion], coverage: float) -> tuple[str, ...]:
    """A sentence on each common factor of scales that is beyond what the applied vector can do."""
    return tuple(line.text for line in motions_in_words(motions, coverage) if line.tone == "fail")


def is_significant(motion: CommonMotion) -> bool:
    """Whether the block moved as a whole, beyond what noise does once in a hundred sessions."""
    return motion.state == SEPARATED and motion.p_value is not None and motion.p_value < SIGNIFICANT


def _line(motion: CommonMotion, coverage: float, of_kind: str, since: str) -> MotionLine | None:
    if motion.state == BEYOND:
        return MotionLine("fail", _beyond(motion, coverage, of_kind, since))
    if motion.state != SEPARATED:
        return MotionLine("none", _undivided(motion, of_kind))
    if is_significant(motion):
        return MotionLine("undecidable", joined("", (_together(motion, coverage, of_kind, since), _alone(motion))))
    return None


def _together(motion: CommonMotion, coverage: float, of_kind: str, since: str) -> str:
    if motion.quantity == AXES:
        size = measured(motion.size, coverage * motion.sigma, _turn_measure(motion))
        return say(
            "The whole block{whose} turned by {size} about {motion} {date}: it was mounted differently, or the "
            "stand has turned. {judged}",
            whose=of_kind,
            size=size,
            motion=_about(motion),
            date=since,
            judged=JUDGED,
        )
    cause = "gravity or the stand's elevation" if motion.kind == ACCELEROMETER else "the stand or its clock"
    parts = {"whose": of_kind, "size": _factor(motion, coverage), "date": since, "cause": cause, "judged": JUDGED}
    return say("All scale factors{whose} changed together by {size} {date}; cause: {cause}. {judged}", **parts)


def _factor(motion: CommonMotion, coverage: float) -> str:
    """``+1.0000 ± 0.0009 %``."""
    return signed(motion.size, coverage * motion.sigma, deviation_measure(motion.kind, "scale", motion.size))


def _beyond(motion: CommonMotion, coverage: float, of_kind: str, since: str) -> str:
    """A common factor that is the unit's, or of what reads it."""
    parts = {"whose": of_kind, "size": _factor(motion, coverage), "date": since}
    parts["input"] = "gravity at the stated place" if motion.kind == ACCELEROMETER else "the stand or its clock"
    return say(
        "All scale factors{whose} changed together by {size} {date}, more than {input} can: check the supply voltage, "
        "the converter's reference, the range setting and the temperature. Every sensor is judged by its whole change.",
        **parts,
    )


def _turn_measure(motion: CommonMotion) -> Measure:
    """The measure of a turn: degrees where the block was mounted otherwise."""
    if motion.size >= DEGREE:
        return COARSE_MEASURES[motion.kind, "axis"]
    return deviation_measure(motion.kind, "axis", motion.size)


def _about(motion: CommonMotion) -> str:
    """The block's axis that the turn is about, or the direction."""
    direction = [component / motion.size for component in motion.value]
    largest = max(range(3), key=lambda i: abs(direction[i]))
    if abs(direction[largest]) > NEARLY:
        return f"{'−' if direction[largest] < 0 else ''}{'XYZ'[largest]}"
    return "(" + ", ".join(number(component, 2) for component in direction) + ")"


def _alone(motion: CommonMotion) -> str:
    """The sentence on sensors that did not move with the others."""
    if not motion.left_out:
        return ""
    parameter = "input axis" if motion.quantity == AXES else "scale factor"
    *others, last = motion.left_out
    if not others:
        return say(" In addition, the {what} of {last} changed.", what=parameter, last=last)
    several = "input axes" if motion.quantity == AXES else "scale factors"
    parts = {"several": several, "others": joined(", ", others), "last": last}
    return say(" In addition, the {several} of {others} and {last} changed.", **parts)


def _undivided(motion: CommonMotion, of_kind: str) -> str:
    turn = (
        say("a turn of the whole block{kinds}", kinds=of_kind)
        if motion.quantity == AXES
        else say("a change of all scale factors{kinds}", kinds=of_kind)
    )
    scaling = "a change of one sensor"
    judged = "every sensor is judged by its whole change"
    if motion.state == UNCLEAR:
        return say(
            "The sensors do not agree on {turn}, and which of them changed is not known: {judged}.",
            turn=turn,
            judged=judged,
        )
    parts = {"sensors": few(len(motion.sensors), "sensor"), "turn": turn, "scaling": scaling, "judged": judged}
    return say("{sensors} to separate {turn} from {scaling}: {judged}.", **parts)
