"""Tasks that wait for a person, by role."""

import pytest

from service.app import create_app
from service.kit.person import Role
from tests.conftest import SettingsHolding
from tests.databases import one_engine
from tests.service.made_sessions import FAILED
from tests.service.people.staff import staffed
from tests.serving import http_client
from tests.stock import stores

ASSIGN = {"to": "Crew", "by": "Engineer"}


@one_engine
@pytest.mark.parametrize(
    ("role", "kinds"), [(Role.VIEWER, []), (Role.CREW, ["assigned-to-me"]), (Role.ENGINEER, ["unassigned-flag"])]
)
def test_everybody_sees_what_they_can_act_on(settings_holding: SettingsHolding, role: Role, kinds: list[str]) -> None:
    settings = settings_holding(*FAILED)
    with stores(settings) as storage:
        staff = staffed(storage)
    with http_client(create_app(settings)) as http:
        [flag] = http.get("/api/v1/flags", headers=staff.headers(Role.VIEWER)).json()["flags"]
        if role is Role.CREW:
            path = f"/api/v1/flags/{flag['id']}/assign"
            http.post(path, json=ASSIGN, headers=staff.headers(Role.ENGINEER)).raise_for_status()
        answer = http.get("/api/v1/review", headers=staff.headers(role)).json()["waiting"]
        assert [one["kind"] for one in answer] == kinds
        page = http.get("/review", headers=staff.headers(role)).text
        assert ("Nothing waits for you." in page) is not bool(kinds)
        assert all(one["page"] in page for one in answer)
