"""What causes are called: one alone, one on its sensors, and several that a session cannot distinguish."""

from collections.abc import Sequence

from estimator.causes import find
from estimator.diagnosis import Finding
from service.words.names import spaced

UNKNOWN_CAUSE = "unexplained"
"""Stands among the alternatives of a finding that a cause which is not in the catalogue fits as well as."""
ONE_NOT_KNOWN = "one that is not in the catalogue"
MOST_NAMES = 3
"""Causes that a sentence lists before it counts the rest: more than three are no longer read."""


def cause_name(identifier: str) -> str:
    """``bias temperature``; a cause that this version does not know is called by its identifier."""
    if identifier == UNKNOWN_CAUSE:
        return ONE_NOT_KNOWN
    known = find(identifier)
    return spaced(identifier) if known is None else known.name


def cause_on(identifier: str, sensors: Sequence[str]) -> str:
    """``bias temperature (A5)``."""
    return cause_name(identifier) + _on(sensors)


def is_lone(finding: Finding) -> bool:
    """Whether it is the only known cause that fits, beside one that is not in the catalogue."""
    return finding.alternatives == (UNKNOWN_CAUSE,)


def what_is_wrong(finding: Finding, findings: Sequence[Finding] = ()) -> str:
    """What is wrong in a sentence; of several equal causes their names: ``Cannot tell which: ramp or warm up (A3).``

    ``findings``: all of the diagnosis. A sensor with two names has two causes at once, or one that nobody knows.
    """
    if not finding.alternatives:
        return finding.sentence
    at_once = at_once_with(finding, findings)
    if at_once:
        count, names = "Two" if len(at_once) == 2 else "Several", " and ".join(map(cause_name, at_once))
        return f"{count} causes at once, or {ONE_NOT_KNOWN}{_on(finding.sensors)}: {names}."
    return f"Cannot tell which: {_listed((finding.cause, *finding.alternatives))}{_on(finding.sensors)}."


def at_once_with(finding: Finding, findings: Sequence[Finding]) -> tuple[str, ...]:
    """The causes, strongest first, that act together where an unknown one alone would do; empty where none do."""
    if not (is_lone(finding) and finding.sensors):
        return ()
    causes = tuple(f.cause for f in findings if f.sensors == finding.sensors)
    return causes if len(causes) > 1 else ()


def _on(sensors: Sequence[str]) -> str:
    return f" ({', '.join(sensors)})" if sensors else ""


def _listed(causes: Sequence[str]) -> str:
    """``a, b or c``; of many only the first three, and always that it may be an unknown one."""
    names = [cause_name(identifier) for identifier in causes if identifier != UNKNOWN_CAUSE]
    shown, more = names[:MOST_NAMES], len(names) - MOST_NAMES
    shown += [f"{more} more"] if more > 0 else []
    shown += [ONE_NOT_KNOWN] if UNKNOWN_CAUSE in causes else []
    return f"{', '.join(shown[:-1])} or {shown[-1]}"
