"""Pages stay light with long histories and large blocks."""

import gzip
from dataclasses import replace
from datetime import timedelta

from fastapi import Request

from service.pages.unit.pages import unit_page
from service.pages.unit.report import UnitReport
from service.sessions.records import PARAMETERS
from service.types.records import Tolerances, UnitType
from service.web.render import render
from tests.service.pages.records import NOON, bias_point, unit_summary, uses_of

SESSIONS, SENSORS = 200, 6


def test_unit_with_200_sessions_is_a_fraction_of_a_megabyte() -> None:
    points = [
        replace(bias_point(7 * i, 1e-5 * ((i * 37 + k * 11) % 29), sensor=f"A{k}"), parameter=parameter)
        for i in range(SESSIONS)
        for k in range(SENSORS)
        for parameter in PARAMETERS
    ]
    kind = UnitType("hex-cone", "accelerometer", (), (), (), Tolerances(1e-4, 1e-3, 1e-6, 1e-4), None, 1)
    summary = replace(unit_summary(), sessions=SESSIONS, last_at=NOON + timedelta(days=7 * SESSIONS))
    page = unit_page(UnitReport(summary, kind, None, (), ()), points, uses_of(summary)[summary.serial])
    request = Request({"type": "http", "path": "/units/BA-017", "headers": [], "query_string": b""})
    packed = gzip.compress(bytes(render(request, "unit.html", page).body))
    assert len(packed) < 500_000
