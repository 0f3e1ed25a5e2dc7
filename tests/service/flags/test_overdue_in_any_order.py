"""The flag of an overdue calibration follows from the records and the clock, not by the order in which records came."""

from datetime import UTC, datetime
from itertools import permutations

import httpx
import pytest

from service.app import create_app
from service.records.flagging.overdue_units import flag_overdue
from service.settings import Settings
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.serving import http_client
from tests.stock import stores

UNIT = "BA-017"
NOW = datetime(2029, 6, 1, tzinfo=UTC)
"""Years after every due date."""
SESSIONS = {
    "January": session_bytes(month=1),
    "February": session_bytes(seed=2, month=2),
    "failed": session_bytes(seed=3, month=3, a3_moved=300.0),
}
"""Sessions by name; nothing is due after the last one: the unit is out of tolerance now."""
ORDERS = (*[*permutations(SESSIONS)][::2], ("January", "withdrawn"))


def brought(client: httpx.Client, record: str) -> None:
    if record == "withdrawn":
        found = client.get("/api/v1/sessions", params={"unit": UNIT, "state": "accepted"}).json()["sessions"]
        for one in found:
            done = {"by": "K. Ito", "why": "another unit"}
            client.post(f"/api/v1/sessions/{one['id']}/withdraw", json=done).raise_for_status()
    else:
        client.post("/api/v1/sessions", content=SESSIONS[record]).raise_for_status()


@pytest.mark.slow
@one_engine
@pytest.mark.parametrize("order", ORDERS, ids="-".join)
def test_no_flag_stays_open_where_nothing_is_due(settings: Settings, order: tuple[str, ...]) -> None:
    with http_client(create_app(settings, lambda: NOW)) as client, stores(settings) as storage:
        for record in order:
            flag_overdue(storage, NOW)
            brought(client, record)
        assert [one["due"] for one in client.get("/api/v1/units").json()["units"]] in ([None], [])
        flags = client.get(f"/api/v1/units/{UNIT}/flags").json()["flags"]
        assert "overdue" not in [flag["matter"] for flag in flags if flag["state"] != "resolved"]


@one_engine
@pytest.mark.parametrize("looks", ["only before", "before and after"])
def test_an_open_flag_says_what_is_due_now(settings: Settings, looks: str) -> None:
    with http_client(create_app(settings, lambda: NOW)) as client, stores(settings) as storage:
        brought(client, "January")
        flag_overdue(storage, NOW)
        service = {"kind": "repair", "at": "2026-05-01T09:00:00Z", "by": "R. Lind"}
        client.post(f"/api/v1/units/{UNIT}/services", json=service).raise_for_status()
        if looks == "before and after":
            flag_overdue(storage, NOW)
        flags = client.get(f"/api/v1/units/{UNIT}/flags").json()["flags"]
        assert [(flag["matter"], flag["summary"]) for flag in flags] == [
            ("overdue", "Calibration was due on 1 May 2026. Serviced on 1 May 2026: measure it again.")
        ]
