"""What is worked out once for a session's content."""

from dataclasses import replace

import numpy as np

from estimator import CalibrationSession
from estimator.content import LARGEST, once, remembered
from tests.estimator.calibration.cases import CASES


def counted() -> tuple[list[str], object]:
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
    assert notes_of(session) == notes_of(again) == notes_of(replace(again, sensors=list(again.sensors)))
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
