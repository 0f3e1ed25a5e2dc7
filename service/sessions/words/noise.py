"""The terms of noise at rest in words: their sizes, those that a record does not decide, and those that grew."""

from collections.abc import Collection, Sequence
from itertools import groupby
from math import isfinite

import numpy as np

from estimator.allan.growth import Growth, GrowthCourse, growth
from estimator.allan.results import TERMS, interval_of
from estimator.diagnosis.results import NoiseScale
from estimator.message import joined, say
from service.kit.measures import NOISE, THIN, decimals, in_measure, number
from service.sessions.records import HistoryPoint

Points = Sequence[HistoryPoint]
"""One term of one sensor, oldest first."""
NAMES = {
    "white-noise": "White noise N",
    "bias-instability": "Bias instability B",
    "random-walk": "Random walk K",
    "quantisation": "Quantisation Q",
}
"""Names of the terms, the one that most records decide first."""
MEANINGS = {
    "white-noise": "Scatter of a one-second average at rest: velocity or angle random walk.",
    "bias-instability": "Flicker noise of the bias at rest: averaging does not get below about two thirds of it.",
    "random-walk": "Random walk of the bias at rest, from one one-second average to the next.",
    "quantisation": "Rounding of the counted velocity or angle, at rest.",
}
NOT_DECIDED = "cannot be determined from a record of this length"
SEVERAL = 3
"""Sensors of a kind, from which on all of them together are named in one sentence."""
LEVEL = 0.01
"""Chance that an unchanged unit is reported as noisier, over all its sensors and terms."""


def size_in_words(kind: str, name: str, value: float | None, sigma: float | None) -> str:
    """``0.0401 °/√h (0.0393 to 0.0409)``: a term, SI, and where it lies with 95 %."""
    if value is None or sigma is None:
        return NOT_DECIDED
    measure = NOISE[kind, name]
    digits = decimals(sigma * measure.factor)
    low, high = (number(in_measure(end, measure), digits) for end in interval_of(value, sigma))
    return say(
        "{digits}{thin_space}{label} ({low} to {high})",
        digits=number(in_measure(value, measure), digits),
        thin_space=THIN,
        label=measure.label,
        low=low,
        high=high,
    )


def term_in_words(point: HistoryPoint) -> str:
    """The size of a term at a point of the history."""
    return size_in_words(point.kind, point.parameter, point.value, point.u)


def grown(points: Sequence[HistoryPoint]) -> tuple[str, ...]:
    """The terms that are larger in the newest record than before, in a sentence each; ``points`` of one unit, oldest
    first.
    """
    decided = [p for p in points if p.parameter in TERMS and p.value and p.u]
    if not decided:
        return ()
    newest = decided[-1].session
    courses = [list(course) for _, course in groupby(sorted(decided, key=_place), key=_place)]
    lasting = [course for course in courses if len(course) > 1 and course[-1].session == newest]
    return tuple(s for term in _by_term(lasting) for s in _sentences(term, growth(_sizes(term), LEVEL / len(lasting))))


def _sizes(courses: Sequence[Points]) -> list[GrowthCourse]:
    return [GrowthCourse(np.array([p.value for p in points]), np.array([p.u for p in points])) for points in courses]


def _by_term(courses: Sequence[Points]) -> list[list[Points]]:
    return [list(term) for _, term in groupby(sorted(courses, key=_term), key=_term)]


def _term(course: Points) -> tuple[str, str]:
    return course[0].kind, course[0].parameter


def _sentences(courses: Sequence[Points], found: Sequence[Growth]) -> tuple[str, ...]:
    """One a sensor, or one of all: what makes every sensor noisier is hardly each of them."""
    larger = [(points[-1], g) for points, g in zip(courses, found, strict=True) if g.is_larger]
    if len(larger) < max(SEVERAL, len(courses)):
        return tuple(_sentence(last, g) for last, g in larger)
    last, times = larger[0][0], sorted(g.times for _, g in larger)
    sensors, least, most = f"{last.kind}s", number(times[0], 2), number(times[-1], 2)
    return (
        say(
            "{names} has grown in all {sensors}, {least} to {greatest} times. Check the bench and nearby "
            "machinery first.",
            names=NAMES[last.parameter],
            sensors=sensors,
            least=least,
            greatest=most,
        ),
    )


def _place(point: HistoryPoint) -> tuple[str, str]:
    return point.sensor, point.parameter


def _sentence(last: HistoryPoint, found: Growth) -> str:
    measure = NOISE[last.kind, last.parameter]
    return say(
        "{names} of {sensor} has grown {times} times: {value}, previously {usual_value}{thin_space}{label}.",
        names=NAMES[last.parameter],
        sensor=last.sensor,
        times=number(found.times, 2),
        value=term_in_words(last),
        usual_value=number(in_measure(found.usual, measure)),
        thin_space=THIN,
        label=measure.label,
    )


WHOLE = 2.95
"""Times from which on they are counted in whole ones: a scale is known to a few per cent at best."""
NEAR = 1.15
"""Times below which a first decimal would not tell them from one."""


TENFOLD = 10.0
"""Times too small from which standard errors are no estimate of the scatter: nobody misjudges a noise by that much, so
something else is in the readings."""


def is_tenfold(noise: Sequence[NoiseScale]) -> bool:
    """Whether the readings of any sensors scatter so far beyond their standard errors that something is unexplained."""
    return any(scale.factor > TENFOLD for scale in noise)


def wrong_errors(noise: Sequence[NoiseScale], kinds: Collection[str]) -> tuple[str, ...]:
    """``The stated standard errors are about 4 times too small.``; by kind where a session holds several,
    and whose they are where not all sensors'."""
    return tuple(say("The {clause}.", clause=clause) for clause in _clauses(noise, kinds))


def but_wrong_errors(noise: Sequence[NoiseScale], kinds: Collection[str]) -> str:
    """The wrong standard errors as the end of a sentence: ``, but the stated …``; empty where the readings contradict
    none.
    """
    clauses = _clauses(noise, kinds)
    return (
        say(", but {clause}", clause=joined(" and ", (say("the {clause}", clause=clause) for clause in clauses)))
        if clauses
        else ""
    )


def _clauses(noise: Sequence[NoiseScale], kinds: Collection[str]) -> list[str]:
    return [
        say("stated standard errors{subset} are {factor}", subset=_whose(n, kinds), factor=_how_far_off(n.factor))
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
    """The size of the error, from the factor by which they are too small; below one they are too large."""
    if not isfinite(factor) or factor <= 0:
        return "wrong by an unknown factor"
    side = "small" if factor > 1 else "large"
    return say("about {factor} times too {size}", factor=_rounded(max(factor, 1 / factor)), size=side)


def _rounded(times: float) -> str:
    """``4``, ``1.4``, ``1.05``, ``140``."""
    if times < WHOLE:
        return number(round(times, 1 if times >= NEAR else 2))
    return number(float(f"{times:.2g}"), 0)
