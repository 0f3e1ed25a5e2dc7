"""What causes are called: one alone, one on its sensors, and several that a session cannot distinguish."""

from collections.abc import Sequence

from estimator.causes import find
from estimator.diagnosis import Finding
from service.words.names import spaced

MOST_NAMES = 3
"""Causes that a sentence lists before it counts the rest: more than three are no longer read."""


def cause_name(identifier: str) -> str:
    """``bias temperature``; a cause that this version does not know is called by its identifier."""
    known = find(identifier)
    return spaced(identifier) if known is None else known.name


def cause_on(identifier: str, sensors: Sequence[str]) -> str:
    """``bias temperature (A5)``."""
    return cause_name(identifier) + _on(sensors)


def what_is_wrong(finding: Finding) -> str:
    """What is wrong in a sentence; of several equal causes their names: ``Cannot tell which: ramp or warm up (A3).``"""
    if not finding.alternatives:
        return finding.sentence
    names = [cause_name(identifier) for identifier in (finding.cause, *finding.alternatives)]
    return f"Cannot tell which: {_listed(names)}{_on(finding.sensors)}."


def _on(sensors: Sequence[str]) -> str:
    return f" ({', '.join(sensors)})" if sensors else ""


def _listed(names: Sequence[str]) -> str:
    """``a, b or c``; of many only the first three."""
    if len(names) > MOST_NAMES:
        return f"{', '.join(names[:MOST_NAMES])} or {len(names) - MOST_NAMES} more"
    return f"{', '.join(names[:-1])} or {names[-1]}"
