"""What a recording in service says of its unit, in a sentence or two that a technician understands."""

from estimator.parity import ParityResult
from estimator.parity.results import SEVERAL, Candidate
from service.judging.words import NOTHING_JUDGED
from service.kit.measures import COVERAGE, in_words, number
from service.kit.names import PARAMETER_NAMES
from service.sessions.decision import Decision, Verdict

ALIKE = "with one another as they did at the calibration"
SAME = f"The sensors agree {ALIKE}"
CHANGED = f"The sensors do not agree {ALIKE}"
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
        return f"{found}. {NOTHING_JUDGED}"
    if result.detected:
        return f"{found}."
    if not unseen:
        allowed = ", with what motion does allowed for" if result.moving else ""
        return f"{SAME}{allowed}: a change as large as any tolerance would have been seen."
    return f"{found}." if result.moving else f"{found}, but {_limit(unseen, result)}."


def found_in_words(result: ParityResult) -> str:
    """What was found, without its full stop."""
    if result.moving:
        return (
            f"{TOO_MUCH_MOTION}: the sensors disagree, and lever arms, delays between channels or vibration could be "
            f"why; {stillness(result)}"
        )
    if not result.detected:
        return SAME
    best = result.candidates[0]
    if not result.explained:
        return (
            f"A change that no single sensor explains; {best.sensor} explains most of it. "
            "Calibrate the unit before it is used"
        )
    if result.isolated is not None:
        moved = " or ".join(_moved(c, result.kind) for c in result.candidates)
        said = clipped_in_words(result, best.sensor)
        return f"{best.sensor} has changed since the calibration: {moved}; the others agree{said and f'; {said}'}"
    listed = " or ".join(f"{c.sensor} ({PARAMETER_NAMES[c.kind]})" for c in result.candidates[:MOST_CANDIDATES])
    return f"Something has changed since the calibration, and this recording cannot tell what: {listed}"


def stillness(result: ParityResult) -> str:
    """What to do so that motion does not hide a change."""
    seconds = REST * (result.block_seconds or 1.0)
    return (
        f"hold the unit still for {seconds:.0f} s while recording, or state where its sensors sit (position_m) and "
        "record its gyros beside them"
    )


def clipped_in_words(result: ParityResult, sensor: str) -> str:
    """How often a channel stood at the end of its range; empty for one that did not."""
    share = result.clipped.get(sensor)
    return "" if share is None else f"{sensor} stood at the end of its range in {percent(share)} of the samples"


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
    return f"{PARAMETER_NAMES[candidate.kind]} {moved} (U {in_words(kind, candidate.kind, COVERAGE * sigma)})"


def _limit(unseen: list[Decision], result: ParityResult) -> str:
    """The parameter that is furthest from being seen."""
    blind = [d for d in unseen if d.critical is None]
    if blind:
        names = {PARAMETER_NAMES[d.parameter] for d in blind}
        return f"{' and '.join(sorted(names))} cannot be seen without motion: turn the unit while recording"
    worst = max(unseen, key=lambda d: (d.critical or 0.0) / d.tolerance)
    needed = in_words(worst.kind, worst.parameter, worst.critical or 0.0)
    allowed = in_words(worst.kind, worst.parameter, worst.tolerance)
    longer = "record longer, with slower turns, or set a tolerance that can be decided"
    return (
        f"{worst.sensor} {PARAMETER_NAMES[worst.parameter]} must change by {needed} to be seen, and {allowed} are "
        f"allowed: {stillness(result) if result.motion_share > MOSTLY_MOTION else longer}"
    )
