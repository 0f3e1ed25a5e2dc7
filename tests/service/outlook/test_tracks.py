"""A parameter's history as people read it."""

from dataclasses import replace
from datetime import timedelta

import pytest

from service.outlook.charts import ParameterCourse, tolerance_text, tracks_of
from service.units.records import Service
from tests.service.pages.records import NOON, bias_point

MICRO = 9.80665e-6


def only(groups: tuple[tuple[ParameterCourse, ...], ...]) -> ParameterCourse:
    ((track,),) = groups
    return track


def test_values_are_changes_from_the_reference() -> None:
    track = only(tracks_of([bias_point(0, 1e-2, reference=1e-2), bias_point(9, 1e-2 + 3 * MICRO, reference=1e-2)], ()))
    assert track.unit.label == "µg"
    assert [p.shown for p in track.points] == [0.0, pytest.approx(3.0)]
    assert track.points[1].text.startswith("+3.0\u00a0±\u00a010.2") or track.points[1].text.startswith(
        "+3\u00a0±\u00a010"
    )


def test_service_begins_a_new_epoch() -> None:
    repair = Service(1, "BA-017", NOON + timedelta(days=5), "repair", "")
    track = only(tracks_of([bias_point(d, 0.0) for d in (0, 4, 6)], [repair]))
    assert [p.epoch for p in track.points] == [0, 0, 1]


def test_changes_are_from_the_reference_of_their_own_time() -> None:
    track = only(tracks_of([bias_point(0, 1e-4), bias_point(9, 3e-4, reference=2e-4)], ()))
    assert [p.shown for p in track.points] == [pytest.approx(1e-4 / MICRO), pytest.approx(1e-4 / MICRO)]


def test_new_tolerance_begins_a_new_stretch() -> None:
    points = [bias_point(0, 0.0), bias_point(4, 0.0), replace(bias_point(9, 0.0), tolerance=2e-4)]
    track = only(tracks_of(points, ()))
    assert [p.day for p in track.limits] == ["1 Mar 2026", "10 Mar 2026"]
    assert tolerance_text(track).startswith("±20.39")


def test_first_value_stands_in_for_a_missing_reference() -> None:
    track = only(tracks_of([bias_point(0, 1e-2, reference=None), bias_point(4, 2e-2, reference=None)], ()))
    assert track.points[0].shown == 0.0
    assert track.points[1].shown == pytest.approx(1e-2 / MICRO)


def test_without_a_reference_there_are_no_tolerance_lines() -> None:
    track = only(tracks_of([bias_point(0, 1e-2, reference=None)], ()))
    assert (track.limits, tolerance_text(track)) == ((), "not set")


def test_unobserved_value_is_said_and_not_drawn() -> None:
    track = only(tracks_of([bias_point(0, None)], ()))
    assert (track.points[0].text, track.points[0].shown) == ("not observable", None)


def test_sensors_stand_in_the_order_people_count() -> None:
    (group,) = tracks_of([bias_point(0, 0.0, sensor=s) for s in ("A10", "A2", "A1")], ())
    assert [t.sensor for t in group] == ["A1", "A2", "A10"]
