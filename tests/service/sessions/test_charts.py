"""Data that charts draw."""

from dataclasses import replace
from datetime import timedelta

from service.outlook.charts import history_charts, tracks_of
from service.units.records import Service
from tests.service.pages.records import NOON, bias_point


def test_tolerance_reaches_from_edge_to_edge() -> None:
    points = [bias_point(0, 0.0), replace(bias_point(50, 0.0), tolerance=2e-4), bias_point(100, 0.0)]
    (tracks,) = tracks_of(points, ())
    limits = history_charts(tracks, ()).panels[0].datasets["limits"]
    assert [one["from"][:10] for one in limits] == ["2026-02-25", "2026-04-20", "2026-06-09"]
    assert [one["to"][:10] for one in limits] == ["2026-04-20", "2026-06-09", "2026-06-13"]


def test_sessions_at_one_moment_still_have_a_width() -> None:
    (tracks,) = tracks_of([bias_point(0, 0.0)], ())
    (limit,) = history_charts(tracks, ()).panels[0].datasets["limits"]
    assert limit["from"] < limit["to"]


def test_unobserved_points_are_not_drawn_and_services_are() -> None:
    repair = Service(1, "BA-017", NOON + timedelta(days=5), "repair", "A1 replaced")
    (tracks,) = tracks_of([bias_point(0, None), bias_point(9, 0.0)], [repair])
    data = history_charts(tracks, [repair]).panels[0].datasets
    assert [p["epoch"] for p in data["points"]] == [1]
    assert [s["what"] for s in data["services"]] == ["repair"]


def test_all_sensors_share_one_range() -> None:
    (tracks,) = tracks_of([bias_point(0, 0.0, sensor="A1"), bias_point(0, 2e-2, sensor="A2")], ())
    scales = [
        layer["encoding"]["y"]["scale"]["domain"]
        for layer in history_charts(tracks, ()).spec["layer"]
        if "scale" in layer["encoding"].get("y", {})
    ]
    assert scales
    assert all(low < 0 and high > 2e-2 / 9.80665e-6 for low, high in scales)
