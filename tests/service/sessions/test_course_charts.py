"""The course of parity is drawn sensor by sensor, with the moment from which one fails."""

import json
from dataclasses import replace
from functools import cache

from estimator import calibrate, read_session
from estimator.parity import CourseFault, ParityResult, parity_check
from service.papers.typeset import picture
from service.sessions.course_charts import course_charts
from tests.service.made_sessions import session_bytes
from tests.service.recordings import recording_document

STUCK = CourseFault("A3", ("A3",), "stuck", 40.0, None, 0.05, None, None, 1e-9)


@cache
def sound() -> ParityResult:
    reference = calibrate(read_session(json.loads(session_bytes())))
    return parity_check(read_session(recording_document(seconds=60)), reference)


def test_a_sound_recording_has_no_mark() -> None:
    [charts] = course_charts(sound())
    assert [panel.title for panel in charts.panels] == ["A1", "A2", "A3", "A4", "A5", "A6"]
    assert not any(panel.datasets["faults"] for panel in charts.panels)


def test_the_failing_sensor_comes_first_and_is_labelled_where_it_begins() -> None:
    [charts] = course_charts(replace(sound(), faults=(STUCK,)))
    first, second = charts.panels[:2]
    assert (first.title, first.description) == ("A3", "A3 stands still")
    [mark] = first.datasets["faults"]
    assert (mark["since"], mark["text"], mark["late"]) == (40.0, "A3 stands still", True)
    assert mark["until"] > 58
    assert [mark["text"] for mark in second.datasets["faults"]] == [""]


def test_what_an_earlier_release_stored_has_fewer_points() -> None:
    earlier = replace(sound(), course_fine=None, course_fine_time=None, course_fine_sigma=None)
    counts = [len(course_charts(result)[0].panels[0].datasets["points"]) for result in (sound(), earlier)]
    assert counts == [60, sound().groups]


def test_paper_draws_the_same_definition() -> None:
    [charts] = course_charts(replace(sound(), faults=(STUCK,)))
    assert "A3 stands still" in picture(charts, charts.panels[0], 235)
