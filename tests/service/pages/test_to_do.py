"""Everything that waits for a person, by role, stands on one page with the flags."""

import json

import pytest

from service.app import create_app
from service.kit.person import Role
from tests.conftest import SettingsHolding
from tests.databases import one_engine
from tests.service.made_sessions import FAILED, session_bytes
from tests.service.people.staff import staffed
from tests.serving import http_client
from tests.stock import stores

LATE = session_bytes(unit="BA-018", started_at="2021-03-01T09:00:00Z")
"""Long overdue by now."""


def coarse(document: bytes) -> bytes:
    """The session with standard errors so large that nothing can be decided by it."""
    session = json.loads(document)
    table = session["table"]
    errors = {name: [40 * se for se in column] for name, column in table.items() if name.endswith("_se")}
    return json.dumps(session | {"table": table | errors}).encode()


@one_engine
@pytest.mark.parametrize(("role", "overdue"), [(Role.VIEWER, False), (Role.CREW, True), (Role.ENGINEER, True)])
def test_everybody_sees_what_they_can_act_on(settings_holding: SettingsHolding, role: Role, overdue: bool) -> None:
    settings = settings_holding(LATE, *FAILED)
    with stores(settings) as storage:
        staff = staffed(storage)
    with http_client(create_app(settings)) as http:
        page = http.get("/flags", headers=staff.headers(role)).text
        assert "A3: out of tolerance" in page
        assert ("Calibration overdue: 1 unit." in page) is overdue
        assert "Calibration overdue: 1 unit." not in http.get("/flags?matter=stand", headers=staff.headers(role)).text


@one_engine
def test_a_unit_that_must_not_be_used_is_listed_without_a_flag_too(settings_holding: SettingsHolding) -> None:
    settings = settings_holding(session_bytes(month=10), coarse(session_bytes(seed=2, month=11)))
    with http_client(create_app(settings)) as http:
        unit = http.get("/api/v1/units").json()["units"][0]
        assert (unit["usable"], unit["flags"]) == (False, 0)
        assert unit["use"] == "Do not use: measure more positions or average longer"
        page = http.get("/flags").text
        assert f"{unit['use']}. " in page
