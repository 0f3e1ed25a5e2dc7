"""A chart of a long history shows what all its sessions would."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import timedelta

import numpy as np

from service.outlook.charts import history_charts, tracks_of
from service.outlook.rules.histories import MeasuredChange, changes_of
from service.outlook.rules.thinned import LISTED, MOST, STRETCHES, drawn
from service.sessions.decision import Verdict
from service.sessions.records import HistoryPoint
from service.units.records import Service
from tests.service.pages.records import NOON, bias_point

RNG = np.random.default_rng(3)
VALUES = 1e-4 * RNG.standard_normal(600)
POINTS = [bias_point(3 * i, float(value)) for i, value in enumerate(VALUES)]


def shown(points: Sequence[HistoryPoint], services: Sequence[Service] = ()) -> tuple[MeasuredChange, ...]:
    changes = changes_of(points, services)
    return tuple(changes[i] for i in sorted(drawn(changes)))


def test_a_short_history_is_shown_whole() -> None:
    assert [change.point for change in shown(POINTS[:MOST])] == POINTS[:MOST]


def test_a_long_one_is_shown_by_a_few_marks_a_stretch() -> None:
    found = [change.point for change in shown(POINTS)]
    assert len(found) <= 3 * (STRETCHES + 1)
    assert found[-1] == POINTS[-1]


def test_the_newest_points_are_kept_for_the_table() -> None:
    ((track,),) = tracks_of(POINTS, ())
    assert [point.session for point in track.points[-LISTED:]] == [point.session for point in POINTS[-LISTED:]]
    data = history_charts([track], ()).panels[0].datasets["points"]
    assert len(data) == len(shown(POINTS)) < len(track.points)


def test_no_session_lies_outside_what_is_shown_near_it() -> None:
    found = shown(POINTS)
    near = (POINTS[-1].at - POINTS[0].at) / STRETCHES
    for point in POINTS:
        values = [one.value for one in found if abs(one.point.at - point.at) <= near]
        assert min(values) <= point.value <= max(values)


def test_a_session_that_differs_is_shown() -> None:
    failed, wide = replace(POINTS[100], verdict=Verdict.FAIL), replace(POINTS[200], expanded=9e-4)
    found = [change.point for change in shown([*POINTS[:100], failed, *POINTS[101:200], wide, *POINTS[201:]])]
    assert failed in found
    assert wide in found


def test_both_sides_of_a_service_are_shown() -> None:
    repair = Service(1, "BA-017", POINTS[301].at - timedelta(hours=1), "repair", "")
    assert POINTS[301] in [change.point for change in shown(POINTS, [repair])]


def test_sessions_of_one_moment_are_shown_by_their_extremes() -> None:
    found = [change.value for change in shown([replace(point, at=NOON) for point in POINTS])]
    assert {min(VALUES), max(VALUES)} <= set(found)


def test_the_range_of_a_chart_stays() -> None:
    (tracks,) = tracks_of(POINTS, ())
    y = next(layer["encoding"]["y"] for layer in history_charts(tracks, ()).spec["layer"][::-1])
    low, high = y["scale"]["domain"]
    assert low < min(min(VALUES) - 1e-4, -5e-4) / 9.80665e-6
    assert high > max(max(VALUES) + 1e-4, 5e-4) / 9.80665e-6
