"""What a recording in service says of its unit, in a sentence or two that a technician understands."""

from estimator.message import joined, say
from estimator.parity import ParityResult
from estimator.parity.results import SEVERAL, Candidate
from service.judging.words import NOTHING_JUDGED
from service.kit.measures import COVERAGE, in_words, number
from service.kit.names import PARAMETER_NAMES
from service.sessions.decision import Decision, Verdict

ALIKE = "with one another as they did at the calibration"
SAME = say("The sensors agree {alike}", alike=ALIKE)
CHANGED = say("The sensors do not agree {alike}", alike=ALIKE)
TOO_MUCH_MOTION = "Moving too much to tell"
REST = 15
"""Blocks at rest that are asked for: twelve are needed, and the first and the last are never whole."""
MOSTLY_MOTION = 0.5
"""Share of what hides a change from which stillness helps more than length."""
MOST_CANDIDATES = 6
"""Sensors that a sentence lists: a block of the common kind has no more."""
LEAST_SHARE = 1e-3
"""Of the samples, below which the share itself tells nobody more."""


def reason(result: ParityResult, decisions: tuple[Decision, ...]) -> str:
    """What was found, and what could not have been."""
    found = found_in_words(result)
    unseen = [d for d in decisions if d.verdict is Verdict.UNDECIDABLE]
    if not decisions:
        return say("{found}. {nothing_judged}", found=found, nothing_judged=NOTHING_JUDGED)
    if result.detected:
        return say("{found}.", found=found)
    if not unseen:
        allowed = ", with what motion does allowed for" if result.moving else ""
        return say(
            "{same}{allowed}: a change as large as any tolerance would have been seen.", same=SAME, allowed=allowed
        )
    return (
        say("{found}.", found=found)
        if result.moving
        else say("{found}, but {unseen}.", found=found, unseen=_limit(unseen, result))
    )


def found_in_words(result: ParityResult) -> str:
    """What was found, without its full stop."""
    if result.moving:
        return say(
            "{too_much_motion}: the sensors disagree, and lever arms, delays between channels or "
            "vibration could be why; {result}",
            too_much_motion=TOO_MUCH_MOTION,
            result=stillness(result),
        )
    if not result.detected:
        return SAME
    best = result.candidates[0]
    if not result.explained:
        return say(
            "A change that no single sensor explains; {sensor} explains most of it. Calibrate the "
            "unit before it is used",
            sensor=best.sensor,
        )
    if result.isolated is not None:
        moved = joined(" or ", (_moved(c, result.kind) for c in result.candidates))
        said = clipped_in_words(result, best.sensor)
        return say(
            "{sensor} has changed since the calibration: {moved}; the others agree{said}",
            sensor=best.sensor,
            moved=moved,
            said=said and say("; {said}", said=said),
        )
    listed = joined(
        " or ",
        (
            say("{sensor} ({parameter_names})", sensor=c.sensor, parameter_names=PARAMETER_NAMES[c.kind])
            for c in result.candidates[:MOST_CANDIDATES]
        ),
    )
    return say(
        "Something has changed since the calibration, and this recording cannot tell what: {listed}", listed=listed
    )


def stillness(result: ParityResult) -> str:
    """What to do so that motion does not hide a change."""
    seconds = REST * (result.block_seconds or 1.0)
    return say(
        "hold the unit still for {seconds} s while recording, or state where its sensors sit "
        "(position_m) and record its gyros beside them",
        seconds=f"{seconds:.0f}",
    )


def clipped_in_words(result: ParityResult, sensor: str) -> str:
    """How often a channel stood at the end of its range; empty for one that did not."""
    share = result.clipped.get(sensor)
    return (
        ""
        if share is None
        else say(
            "{sensor} stood at the end of its range in {share} of the samples", sensor=sensor, share=percent(share)
        )
    )


def percent(share: float) -> str:
    """A share, dimensionless, as people say it."""
    return f"{number(100 * share, 1)} %" if share >= LEAST_SHARE else "less than 0.1 %"


def _moved(candidate: Candidate, kind: str) -> str:
    if candidate.kind == SEVERAL:
        return PARAMETER_NAMES[SEVERAL]
    size = candidate.amplitude[0]
    if candidate.kind == "axis":
        size = sum(turn**2 for turn in candidate.amplitude) ** 0.5
    moved = in_words(kind, candidate.kind, size, signed=candidate.kind != "axis")
    sigma = max(candidate.sigma)
    return say(
        "{parameter} {moved} (U {expanded})",
        parameter=PARAMETER_NAMES[candidate.kind],
        moved=moved,
        expanded=in_words(kind, candidate.kind, COVERAGE * sigma),
    )


def _limit(unseen: list[Decision], result: ParityResult) -> str:
    """The parameter that is furthest from being seen."""
    blind = [d for d in unseen if d.critical is None]
    if blind:
        names = {PARAMETER_NAMES[d.parameter] for d in blind}
        return say(
            "{names} cannot be seen without motion: turn the unit while recording", names=joined(" and ", sorted(names))
        )
    worst = max(unseen, key=lambda d: (d.critical or 0.0) / d.tolerance)
    needed = in_words(worst.kind, worst.parameter, worst.critical or 0.0)
    allowed = in_words(worst.kind, worst.parameter, worst.tolerance)
    longer = "record longer, with slower turns, or set a tolerance that can be decided"
    return say(
        "{sensor} {parameter_names} must change by {needed} to be seen, and {allowed} are allowed: {longer}",
        sensor=worst.sensor,
        parameter_names=PARAMETER_NAMES[worst.parameter],
        needed=needed,
        allowed=allowed,
        longer=stillness(result) if result.motion_share > MOSTLY_MOTION else longer,
    )
