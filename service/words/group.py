"""What many sessions show together, in words."""

from collections.abc import Sequence

from estimator.groups import GroupFinding
from service.words.causes import cause_name

NOT_MADE = "The program failed at it: a fault of the program, not of the session. The next version tries again."
FAILED = (
    "The program failed at what these sessions show together: that is a fault of the program, not of the sessions. The "
    "next version of the program tries again."
)
NO_SESSION = "No accepted session calibrates a block."


def over(sessions: int) -> str:
    """``Over 34 sessions``."""
    return "Over one session" if sessions == 1 else f"Over {sessions} sessions"


def summary_of_group(sessions: int, findings: Sequence[GroupFinding], *, unexplained: bool = False) -> str:
    """What the sessions of a group show together, in one line."""
    if not sessions:
        return NO_SESSION
    if findings:
        return f"{over(sessions)}: {' '.join(map(statement, findings))}"
    if unexplained:
        return f"{over(sessions)}: they share structure that no known cause explains."
    return f"{over(sessions)}: nothing wrong found."


def statement(finding: GroupFinding) -> str:
    """What is wrong, and what it may be instead: ``A2 bends with the cube, unless it is odd quadratic.``"""
    if not finding.alternatives:
        return finding.sentence
    others = " or ".join(dict.fromkeys(map(cause_name, finding.alternatives)))
    return f"{finding.sentence.removesuffix('.')}, unless it is {others}."
