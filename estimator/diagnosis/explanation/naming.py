"""A finding in words, and the findings of one cause on several sensors put together."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from estimator.causes.contract import Cause
from estimator.diagnosis.results import Finding
from estimator.message import capitalised, joined, say


def named_cause(cause: Cause, sensors: tuple[str, ...], p_value: float, strength: float) -> Finding:
    """A finding in words, without a size."""
    return Finding(cause.identifier, sentence(cause, sensors), cause.advice, sensors, p_value, strength)


def shared_course(cause: Cause, finding: Finding, who: str, more: int) -> Finding:
    """A finding of sensors that share a course, in words for all of them; ``more`` only follow it."""
    text = capitalised(say(cause.shared_sentence, sensors=who))
    if more:
        text = joined(" ", (text, say("{more} more follow it too weakly to be named singly.", more=more)))
    return replace(finding, sentence=text, advice=cause.shared_advice)


def listed(sensors: tuple[str, ...]) -> str:
    """``A1``, ``each of A1 and A2``, ``each of A1, A2 and A3``."""
    names = list(dict.fromkeys(sensors))
    return (
        say("each of {first} and {last}", first=joined(", ", names[:-1]), last=names[-1])
        if len(names) > 1
        else joined("", names)
    )


def sentence(cause: Cause, sensors: tuple[str, ...]) -> str:
    """Describes the fault of some sensors."""
    text = say(cause.sentence, sensors=listed(sensors))
    return capitalised(text)


def merged(named: Sequence[tuple[Cause, Finding]]) -> list[Finding]:
    """Findings of one cause on several sensors put together, one sentence of all of them."""
    by_cause: dict[str, Finding] = {}
    for cause, f in named:
        old = by_cause.get(f.cause)
        by_cause[f.cause] = f if old is None else as_one(cause, old, f)
    return list(by_cause.values())


def as_one(cause: Cause, a: Finding, b: Finding) -> Finding:
    """Two findings of one cause as one."""
    return replace(
        a,
        **side_by_side(cause, a, b, ("nonlinear_each",)),
        p_value=max(a.p_value, b.p_value),
        new=a.new if a.new == b.new else None,
    )


def side_by_side(cause: Cause, a: Any, b: Any, further: tuple[str, ...]) -> dict[str, Any]:
    """The common fields of two findings of one cause, of a session or of a group; ``further``: fields that hold an
    entry for every sensor or rival.
    """
    names = ("sensors", "amplitude", "sigma", "units", *further)
    whole = {name: getattr(a, name) + getattr(b, name) for name in names}
    return whole | {
        "sentence": sentence(cause, whole["sensors"]),
        "strength": float(np.hypot(a.strength, b.strength)),
        "alternatives": tuple(x for x in a.alternatives if x in b.alternatives),
    }
