"""What many sessions show together, in words."""

from collections.abc import Sequence

from estimator.groups import GroupFinding
from estimator.message import joined, say, uncapitalised, without_stop
from service.diagnosis.words.causes import cause_name, cause_on
from service.groups.records import Group
from service.models.records import Scope

FAILED = (
    "The program failed at what these sessions show together: that is a fault of the program, not of the sessions. The "
    "next version of the program tries again."
)
LONGEST_PLACE = 200
"""Characters that a flag keeps of its place."""
SHARED = "They share structure that no known cause explains."
SOUND = "Nothing wrong found."
UNKNOWN = "Structure that no known cause explains."
NO_SESSION = "No accepted session calibrates a block."


def over(sessions: int) -> str:
    """``Over 34 sessions``."""
    return "Over one session" if sessions == 1 else say("Over {sessions} sessions", sessions=sessions)


def summary_of_group(sessions: int, findings: Sequence[GroupFinding], *, unexplained: bool = False) -> str:
    """What the sessions of a group show together, in one line."""
    if not sessions:
        return NO_SESSION
    if findings:
        return say("{sessions}: {statement}", sessions=over(sessions), statement=joined(" ", map(statement, findings)))
    if unexplained:
        return say("{sessions}: {found}", sessions=over(sessions), found=uncapitalised(SHARED))
    return say("{sessions}: {found}", sessions=over(sessions), found=uncapitalised(SOUND))


def own_of_group(group: Group, findings: Sequence[GroupFinding], *, unexplained: bool) -> str:
    """Of what the sessions show, that which is of the group itself; empty for nothing.

    ``unexplained``: whether they share structure of its own that no cause explains.
    """
    mine = (group.level.value, group.name)
    said = [statement(f) for f in findings if (f.level, f.subject) == mine]
    if unexplained:
        said.append(UNKNOWN)
    return joined(" ", said)


def statement(finding: GroupFinding) -> str:
    """What is wrong, and what it may be instead: ``A2 bends with the cube, unless it is odd quadratic.``"""
    if not finding.alternatives:
        return finding.sentence
    others = joined(" or ", dict.fromkeys(map(cause_name, finding.alternatives)))
    return say("{sentence}, unless it is {others}.", sentence=without_stop(finding.sentence), others=others)


def place_in_words(place: str, subject: str) -> str:
    """The place of a lasting flag as people read it: it is a key, made of scope, subject, cause and sensors."""
    scope, known, rest = place.partition(f" {subject}: ")
    cause, bracket, sensors = rest.partition(" (")
    if not known:
        return place
    of = say(" ({sensors})", sensors=sensors.removesuffix(")")) if bracket else ""
    return say("{scope} {subject}: {cause}{of}", scope=scope, subject=subject, cause=cause, of=of)


def lasting_place(scope: Scope, subject: str, finding: GroupFinding | None = None) -> str:
    """``stand ODG-1: beta eccentricity``: where a flag on it is; without a finding how those of a group begin."""
    whose = f"{scope} {subject}: "
    return whose if finding is None else f"{whose}{cause_on(finding.cause, finding.sensors)}"[:LONGEST_PLACE]


def lasting_summary(scope: Scope, finding: GroupFinding) -> str:
    """``The sessions on stand ODG-1 show together: The angle scale of the head is off centre.``"""
    if scope is Scope.STAND:
        return say(
            "The sessions on stand {subject} show together: {finding}",
            subject=finding.subject,
            finding=statement(finding),
        )
    if scope is Scope.UNIT_TYPE:
        return say(
            "The sessions of unit type {subject} show together: {finding}",
            subject=finding.subject,
            finding=statement(finding),
        )
    return say(
        "The sessions of unit {subject} show together: {finding}", subject=finding.subject, finding=statement(finding)
    )
