"""A unit that has earlier sessions: a cold start is one finding beside them, a lasting change one of the sensor."""

from collections.abc import Callable, Iterator

import numpy as np

from benchmarks.shared_causes.unlike import Line
from benchmarks.study.rates import rate
from estimator import diagnose, read_session
from estimator.diagnosis.results import Diagnosis
from tests.blind.courses import BLOCKS, BOTH, CHANGED, COLD, SOUND, Life, draw_life

EACH = 15.0
"""Strength of every sensor, standard errors."""
DRIFT, COURSE = "sensor-drift", "warm-up"
MEASURED = (BLOCKS[0], BLOCKS[2])


def with_history(sessions: int, seed: int) -> Iterator[Line]:
    """Lines from so many units of every kind and block."""
    for number, block in enumerate(MEASURED):
        drawn = {
            kind: [_diagnosed(number, kind, (seed, number, place, k)) for k in range(sessions)]
            for place, kind in enumerate((SOUND, COLD, BOTH, CHANGED))
        }
        head = f"three warm sessions before it, {block.name}: "
        yield f"{head}{COLD}: one course, nothing else", "≥ 95 %", _rate(drawn[COLD], _is_one_course)
        yield f"{head}{COLD}: a sensor called changed", "≤ 5 %", _rate(drawn[COLD], _names_any_drift)
        yield f"{head}{BOTH}: the course and that sensor, no other", "≥ 95 %", _rate(drawn[BOTH], _names_both)
        yield f"{head}{CHANGED}: these called changed, no other", "≥ 95 %", _rate(drawn[CHANGED], _names_changed)
        yield f"{head}{CHANGED}: a course claimed", "≤ 1 %", _rate(drawn[CHANGED], _names_course)
        yield f"{head}{SOUND}: a name", "≤ 1 %", _rate(drawn[SOUND], lambda _, found: bool(found.findings))


def _diagnosed(number: int, kind: str, seed: tuple[int, ...]) -> tuple[Life, Diagnosis]:
    life = draw_life(MEASURED[number], kind, EACH, np.random.default_rng(seed))
    *earlier, last = map(read_session, life.sessions)
    return life, diagnose(last, earlier)


def _rate(drawn: list[tuple[Life, Diagnosis]], holds: Callable[[Life, Diagnosis], bool]) -> str:
    return str(rate([holds(*pair) for pair in drawn]))


def changed(found: Diagnosis) -> set[str]:
    """Sensors that are called changed for good."""
    return {name for f in found.findings if f.cause == DRIFT for name in f.sensors}


def _is_one_course(life: Life, found: Diagnosis) -> bool:
    return [f.cause for f in found.findings if f.shared is not None] == [COURSE] and len(found.findings) == 1


def _names_any_drift(life: Life, found: Diagnosis) -> bool:
    return bool(changed(found))


def _names_both(life: Life, found: Diagnosis) -> bool:
    return _names_course(life, found) and changed(found) == set(life.changed)


def _names_changed(life: Life, found: Diagnosis) -> bool:
    return changed(found) == set(life.changed)


def _names_course(life: Life, found: Diagnosis) -> bool:
    return any(f.shared is not None for f in found.findings)
