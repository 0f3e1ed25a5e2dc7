"""The terms of noise at rest in words: their sizes, what a record does not decide, and what became larger."""

from collections.abc import Sequence
from itertools import groupby
from math import exp, log, sqrt

from scipy.special import ndtri, stdtrit

from estimator.allan.results import TERMS, freedom_of, interval_of
from service.measures import NOISE, THIN, decimals, in_measure, number
from service.records.history import HistoryPoint

Course = Sequence[HistoryPoint]
"""One term of one sensor, oldest first."""
NAMES = {
    "white-noise": "White noise N",
    "bias-instability": "Bias instability B",
    "random-walk": "Random walk K",
    "quantisation": "Quantisation Q",
}
"""The one that most records decide first."""
MEANINGS = {
    "white-noise": "What an average over one second scatters by, at rest: velocity or angle random walk.",
    "bias-instability": "Flicker of the zero at rest: no average, however long, is better than about two thirds of it.",
    "random-walk": "How the zero walks away at rest, from an average of one second to the next.",
    "quantisation": "Rounding of the counted velocity or angle, at rest.",
}
NOT_DECIDED = "not decided by a record of this length"
SEVERAL = 3
"""Sensors of a kind, from which on all of them together are told in one sentence."""
LEVEL = 0.01
"""Chance that a unit whose noise is the same is said to have become noisier, over all its sensors and terms."""
WORTH = 1.25
"""Growth below which nothing is said: data sheets leave more room, and temperature makes as much."""


def size_in_words(kind: str, name: str, value: float | None, sigma: float | None) -> str:
    """``0.0401 °/√h (0.0393 to 0.0409)``: a term, SI, and where it lies with 95 %."""
    if value is None or sigma is None:
        return NOT_DECIDED
    measure = NOISE[kind, name]
    digits = decimals(sigma * measure.factor)
    low, high = (number(in_measure(end, measure), digits) for end in interval_of(value, sigma))
    return f"{number(in_measure(value, measure), digits)}{THIN}{measure.label} ({low} to {high})"


def term_in_words(point: HistoryPoint) -> str:
    """The same of a point of the history."""
    return size_in_words(point.kind, point.parameter, point.value, point.u)


def grown(points: Sequence[HistoryPoint]) -> tuple[str, ...]:
    """What is larger in the newest record than before, in a sentence each; ``points`` of one unit, oldest first."""
    decided = [p for p in points if p.parameter in TERMS and p.value and p.u]
    if not decided:
        return ()
    newest = decided[-1].session
    courses = [list(own) for _, own in groupby(sorted(decided, key=_place), key=_place)]
    told = [own for own in courses if len(own) > 1 and own[-1].session == newest]
    return tuple(s for own in _by_term(told) for s in _sentences(_larger(own, LEVEL / len(told)), own))


def _by_term(courses: Sequence[Course]) -> list[list[Course]]:
    """Those of one term of one kind of sensor together."""
    return [list(own) for _, own in groupby(sorted(courses, key=_term), key=_term)]


def _term(course: Course) -> tuple[str, str]:
    return course[0].kind, course[0].parameter


def _sentences(larger: Sequence[Course], told: Sequence[Course]) -> tuple[str, ...]:
    """One a sensor, or one of all: what makes every sensor noisier is hardly each of them."""
    if len(larger) < max(SEVERAL, len(told)):
        return tuple(map(_sentence, larger))
    last, times = larger[0][-1], sorted(map(_times, larger))
    sensors, least, most = f"{last.kind}s", number(times[0], 2), number(times[-1], 2)
    return (
        f"{NAMES[last.parameter]} is larger in all {sensors}: {least} to {most} times what it was. Look at the bench "
        "and at what runs beside it first.",
    )


def _place(point: HistoryPoint) -> tuple[str, str]:
    return point.sensor, point.parameter


def _larger(courses: Sequence[Course], level: float) -> list[Course]:
    """Of one term of all sensors of a kind: whose last size exceeds the mean of those before by more than chance and
    than what is worth words.

    In logarithms, whose variance is 1/(2ν), and between records what all sensors scatter by beyond that: its own
    degrees of freedom give Student's t. Of a single record before nothing is known of that.
    """
    freedom = sum(len(own) - 2 for own in courses)
    squares = sum((log(p.value or 1.0) - _centre(own[:-1])) ** 2 for own in courses for p in own[:-1])
    inner = sum((len(own) - 2) * _mean_variance(own) for own in courses)
    beyond = max(0.0, squares - inner) / freedom if freedom else 0.0
    limit = float(stdtrit(freedom, 1 - level)) if freedom else -float(ndtri(level))
    return [own for own in courses if _change(own) > max(limit * _sigma(own, beyond), log(WORTH))]


def _change(course: Course) -> float:
    """Logarithm of the newest over what was usual."""
    return log(course[-1].value or 1.0) - _centre(course[:-1])


def _sigma(course: Course, beyond: float) -> float:
    """One sigma of the change."""
    return sqrt(_variance(course[-1]) + beyond + (_mean_variance(course) + beyond) / (len(course) - 1))


def _mean_variance(course: Course) -> float:
    """Of the logarithms before the newest."""
    return sum(map(_variance, course[:-1])) / (len(course) - 1)


def _centre(points: Sequence[HistoryPoint]) -> float:
    return sum(log(p.value or 1.0) for p in points) / len(points)


def _variance(point: HistoryPoint) -> float:
    return 1 / (2 * freedom_of(point.value or 1.0, point.u or 1.0))


def _sentence(course: Course) -> str:
    *before, last = course
    measure, usual = NOISE[last.kind, last.parameter], exp(_centre(before))
    return (
        f"{NAMES[last.parameter]} of {last.sensor} is {number(_times(course), 2)} times what it was: "
        f"{term_in_words(last)}, before {number(in_measure(usual, measure))}{THIN}{measure.label}."
    )


def _times(course: Course) -> float:
    """The newest over what was usual."""
    return exp(_change(course))
