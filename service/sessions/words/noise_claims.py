"""Stated standard errors that the readings contradict, in a sentence."""

from collections.abc import Collection, Sequence
from math import isfinite

from estimator.diagnosis.results import NoiseScale
from estimator.message import joined, say
from service.kit.measures import number

WHOLE = 2.95
"""Times from which on they are counted in whole ones: a scale is known to a few per cent at best."""
NEAR = 1.15
"""Times below which a first decimal would not tell them from one."""


def wrong_errors(noise: Sequence[NoiseScale], kinds: Collection[str]) -> tuple[str, ...]:
    """``The stated standard errors are about 4 times too small.``; by kind where a session holds several,
    and whose they are where not all sensors'."""
    return tuple(say("The {clause}.", clause=clause) for clause in _clauses(noise, kinds))


def but_wrong_errors(noise: Sequence[NoiseScale], kinds: Collection[str]) -> str:
    """The same as the end of a sentence: ``, but the stated …``; empty where the readings contradict none."""
    clauses = _clauses(noise, kinds)
    return (
        say(", but {clause}", clause=joined(" and ", (say("the {clause}", clause=clause) for clause in clauses)))
        if clauses
        else ""
    )


def _clauses(noise: Sequence[NoiseScale], kinds: Collection[str]) -> list[str]:
    return [
        say("stated standard errors{some} are {factor}", some=_whose(n, kinds), factor=_how_far_off(n.factor))
        for n in noise
    ]


def _whose(scale: NoiseScale, kinds: Collection[str]) -> str:
    if scale.sensors:
        *others, last = scale.sensors
        return (
            say(" of {others} and {last}", others=joined(", ", others), last=last)
            if others
            else say(" of {last}", last=last)
        )
    return say(" of the {kind}s", kind=scale.kind) if len(set(kinds)) > 1 else ""


def _how_far_off(factor: float) -> str:
    """Of the factor by which they are too small; below one they are too large."""
    if not isfinite(factor) or factor <= 0:
        return "wrong by more than can be told"
    side = "small" if factor > 1 else "large"
    return say("about {factor} times too {side}", factor=_rounded(max(factor, 1 / factor)), side=side)


def _rounded(times: float) -> str:
    """``4``, ``1.4``, ``1.05``, ``140``."""
    if times < WHOLE:
        return number(round(times, 1 if times >= NEAR else 2))
    return number(float(f"{times:.2g}"), 0)
