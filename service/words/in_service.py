"""What a recording in service says of its unit, in a sentence or two that a technician understands."""

from estimator.parity import ParityResult
from estimator.parity.results import SEVERAL, Candidate
from service.measures import in_words
from service.records.decision import Decision, Verdict
from service.words.names import PARAMETER_NAMES
from service.words.verdict import NOTHING_JUDGED

ALIKE = "with one another as they did at the calibration"
SAME = f"The sensors agree {ALIKE}"
CHANGED = f"The sensors do not agree {ALIKE}"
MOST_CANDIDATES = 6
"""Sensors that a sentence lists: a block of the common kind has no more."""


def reason(result: ParityResult, decisions: tuple[Decision, ...]) -> str:
    """What was found, and what could not have been."""
    found = found_in_words(result)
    unseen = [d for d in decisions if d.verdict is Verdict.UNDECIDABLE]
    if not decisions:
        return f"{found}. {NOTHING_JUDGED}"
    if result.detected or not unseen:
        return f"{found}{'.' if result.detected else ': a change as large as any tolerance would have been seen.'}"
    return f"{found}, but {_limit(unseen)}."


def found_in_words(result: ParityResult) -> str:
    """What was found, without its full stop."""
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
        return f"{best.sensor} has changed since the calibration: {moved}; the others agree"
    listed = " or ".join(f"{c.sensor} ({PARAMETER_NAMES[c.kind]})" for c in result.candidates[:MOST_CANDIDATES])
    return f"Something has changed since the calibration, and this recording cannot tell what: {listed}"


def _moved(candidate: Candidate, kind: str) -> str:
    if candidate.kind == SEVERAL:
        return PARAMETER_NAMES[SEVERAL]
    size = candidate.amplitude[0]
    if candidate.kind == "axis":
        size = sum(turn**2 for turn in candidate.amplitude) ** 0.5
    moved = in_words(kind, candidate.kind, size, signed=candidate.kind != "axis")
    sigma = max(candidate.sigma)
    return f"{PARAMETER_NAMES[candidate.kind]} {moved} (U {in_words(kind, candidate.kind, 2 * sigma)})"


def _limit(unseen: list[Decision]) -> str:
    """The parameter that is furthest from being seen."""
    blind = [d for d in unseen if d.critical is None]
    if blind:
        names = {PARAMETER_NAMES[d.parameter] for d in blind}
        return f"{' and '.join(sorted(names))} cannot be seen without motion: turn the unit while recording"
    worst = max(unseen, key=lambda d: (d.critical or 0.0) / d.tolerance)
    needed = in_words(worst.kind, worst.parameter, worst.critical or 0.0)
    allowed = in_words(worst.kind, worst.parameter, worst.tolerance)
    return (
        f"{worst.sensor} {PARAMETER_NAMES[worst.parameter]} must change by {needed} to be seen, and {allowed} are "
        "allowed: record longer, with slower turns, or set a tolerance that can be decided"
    )
