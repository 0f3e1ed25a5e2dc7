"""Pages stay light with long histories and large blocks."""

import gzip
from dataclasses import replace

from fastapi import Request

from service.pages.unit.parameters import parameter_heads, parameter_page
from service.units.records import NO_EVENTS
from service.web.render import render
from tests.service.pages.records import bias_point

SESSIONS, SENSORS = 500, 6


def test_a_parameter_of_500_sessions_is_a_fraction_of_a_megabyte() -> None:
    points = [
        bias_point(7 * i, 1e-5 * ((i * 37 + k * 11) % 29), sensor=f"A{k}")
        for i in range(SESSIONS)
        for k in range(SENSORS)
    ]
    (head,) = parameter_heads(points[-SENSORS:], "bias")
    page = parameter_page("BA-017", head, points, 10_000, NO_EVENTS, None, raw=False)
    request = Request({"type": "http", "path": "/units/BA-017", "headers": [], "query_string": b""})
    packed = gzip.compress(bytes(render(request, "parameter.html", page).body))
    assert len(packed) < 50_000


def test_heads_stand_in_the_order_of_their_conditions() -> None:
    bias = bias_point(0, 0.0)
    heads = parameter_heads(
        [bias, replace(bias, parameter="scale"), replace(bias, parameter="axis", tolerance=None)], "bias"
    )
    assert [head.anchor for head in heads] == ["bias-accelerometer", "scale-accelerometer", "axis-accelerometer"]
