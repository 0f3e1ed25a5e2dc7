"""A check is judged and kept, and moves no due date, in whatever order the files come in."""

from datetime import datetime, timedelta

import httpx
import pytest

from service.app import create_app
from tests.conftest import SettingsHolding
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes, session_id
from tests.serving import http_client

SESSIONS = "/api/v1/sessions"
FIRST, SECOND = session_bytes(month=1), session_bytes(seed=2, month=3)
CHECK = session_bytes(seed=3, month=5)
BAD = session_bytes(seed=3, month=5, a3_moved=300.0)


def outlook(client: httpx.Client) -> tuple[str | None, str]:
    found = client.get("/api/v1/units/BA-017/outlook").json()
    return found["due"], found["action"]


def test_a_check_leaves_the_due_date_where_it_was(client: httpx.Client) -> None:
    for content in (FIRST, SECOND):
        client.post(SESSIONS, content=content)
    before = outlook(client)
    receipt = client.post(SESSIONS, content=CHECK, params={"check": True}).json()
    assert (receipt["is_check"], receipt["verdict"]) == (True, "pass")
    assert outlook(client) == before
    assert "does not change the due date" in client.get(f"/sessions/{receipt['id']}").text


def test_a_check_that_finds_the_unit_unfit_says_so(client: httpx.Client) -> None:
    client.post(SESSIONS, content=FIRST)
    client.post(SESSIONS, files={"file": ("a.json", BAD)}, data={"check": "on"})
    assert outlook(client) == (None, "act-now")
    assert len(client.get("/api/v1/flags").json()["flags"]) == 1


@pytest.mark.slow
@one_engine
def test_every_order_of_arrival_gives_the_same_date(settings_holding: SettingsHolding) -> None:
    found = set()
    for order in ((FIRST, SECOND, CHECK), (SECOND, CHECK, FIRST), (CHECK, FIRST, SECOND)):
        with http_client(create_app(settings_holding())) as client:
            for content in order:
                client.post(SESSIONS, content=content, params={"check": content is CHECK})
            found.add(outlook(client))
    assert len(found) == 1


def test_a_session_is_made_a_check_and_a_calibration_again(client: httpx.Client) -> None:
    for content in (FIRST, SECOND):
        client.post(SESSIONS, content=content)
    before, said = outlook(client), {"by": "K. Ito", "why": "after transport"}
    path = f"{SESSIONS}/{session_id(CHECK)}/check"
    client.post(SESSIONS, content=CHECK)
    after = outlook(client)
    assert after[0] is not None
    assert before[0] is not None
    assert datetime.fromisoformat(after[0]) - datetime.fromisoformat(before[0]) > timedelta(days=30)
    assert client.put(path, json=said | {"is_check": True}).json()["is_check"] is True
    assert outlook(client) == before
    assert client.post(path.removeprefix("/api/v1"), data=said | {"is_check": "false"}).status_code == 303
    assert outlook(client) == after
    assert [line["action"] for line in client.get("/api/v1/audit").json()["lines"]][:2] == ["check", "check"]


@one_engine
def test_a_check_that_is_the_reference_counts(client: httpx.Client) -> None:
    client.post(SESSIONS, content=FIRST, params={"check": True})
    assert client.get(f"{SESSIONS}/{session_id(FIRST)}").json()["is_reference"] is True
    assert outlook(client)[0] is not None
