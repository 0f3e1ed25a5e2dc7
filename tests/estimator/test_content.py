"""Results worked out once for a session's content."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from estimator import CalibrationSession
from estimator.content import LARGEST, REMEMBERED, each_remembered, once, remembered
from tests.estimator.calibration.cases import CASES


@dataclass(frozen=True, eq=False)
class Worked:
    """A result of a session."""

    session: CalibrationSession


def counted() -> tuple[list[str], Callable[[CalibrationSession], str]]:
    """The notes of the sessions that a remembered function was really asked for, and the function."""
    asked: list[str] = []

    @remembered
    def notes_of(session: CalibrationSession) -> str:
        asked.append(session.notes)
        return session.notes

    return asked, notes_of


def test_the_same_content_is_worked_out_once() -> None:
    asked, notes_of = counted()
    (session,) = CASES[0].simulated(1)
    again = replace(session, readings=session.readings.copy())
    assert notes_of(session) == notes_of(again) == notes_of(replace(again, sensors=(*again.sensors,)))
    assert len(asked) == 1


def test_one_reading_more_or_less_is_another_content() -> None:
    asked, notes_of = counted()
    (session,) = CASES[0].simulated(1)
    readings = session.readings.copy()
    readings[0, 0] = np.nextafter(readings[0, 0], np.inf)
    renamed = replace(session, sensors=(replace(session.sensors[0], name="other"), *session.sensors[1:]))
    for one in (session, replace(session, readings=readings), replace(session, notes="other"), renamed):
        notes_of(one)
    assert len(asked) == 4


def test_large_sessions_are_not_kept() -> None:
    asked, notes_of = counted()
    (session,) = CASES[0].simulated(1)
    large = replace(session, readings=np.zeros((LARGEST + 1, 1)))
    notes_of(large), notes_of(large)
    assert len(asked) == 2


def test_an_object_is_asked_once_while_it_lives() -> None:
    asked: list[tuple[str, int]] = []

    @once
    def noted(session: CalibrationSession, number: int) -> int:
        asked.append((session.notes, number))
        return number

    (session,) = CASES[0].simulated(1)
    assert [noted(session, 1), noted(session, 1), noted(session, 2), noted(replace(session), 1)] == [1, 1, 2, 1]
    assert len(asked) == 3


def test_of_several_only_what_was_not_asked_before_is_worked_out() -> None:
    asked: list[tuple[str, int]] = []

    @each_remembered
    def fitted(each: list[Worked], near: int) -> list[str]:
        asked.extend((one.session.notes, near) for one in each)
        return [one.session.notes for one in each]

    first, second, third = (Worked(replace(CASES[0].simulated(1)[0], notes=name)) for name in "abc")
    assert fitted([first, second], 1) == ["a", "b"]
    assert fitted([third, second], 1) == ["c", "b"]
    assert asked == [("a", 1), ("b", 1), ("c", 1)]
    fitted([first], 2)
    assert asked[-1] == ("a", 2)


def test_of_several_only_the_last_are_remembered() -> None:
    asked: list[int] = []

    @each_remembered
    def number(each: list[Worked], k: int) -> list[int]:
        asked.append(k)
        return [k] * len(each)

    one = Worked(CASES[0].simulated(1)[0])
    for k in (*range(REMEMBERED + 1), REMEMBERED, 0):
        number([one], k)
    assert asked == [*range(REMEMBERED + 1), 0]
