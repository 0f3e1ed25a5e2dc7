"""Gain from naming a cause, in one sentence."""

import re
from collections.abc import Iterator

import numpy as np

from benchmarks.shared_causes.unlike import STAND, Line
from benchmarks.study.rates import rate
from estimator import diagnose, read_session
from service.diagnosis.words.gain import concerned, gain_in_words
from tests.blind.steps import draw_steps

STRENGTH = 20.0
SENTENCE = re.compile(
    r"Held-out error of (\w+) (?:[a-z ]+: [\d.]+ → |falls from [\d.]+ to )[\d.]+ \S+ \(readings that took no part\)\."
)
"""One sensor, one number before and one after."""


def gained(sessions: int, seed: int) -> Iterator[Line]:
    """One sensor whose bias steps."""
    marks = [_is_told((seed, 3, k)) for k in range(sessions)]
    yield "gain of a step of one sensor: one sentence with one number of that sensor", "all", str(rate(marks))


def _is_told(seed: tuple[int, ...]) -> bool:
    hidden = draw_steps(STAND, np.array([STRENGTH]), np.random.default_rng(seed))
    found = diagnose(read_session(hidden.session))
    said = SENTENCE.fullmatch(str(gain_in_words(found.gain, concerned(found.findings))).replace("\u202f", " "))
    return said is not None and said[1] == hidden.sensors[0]
