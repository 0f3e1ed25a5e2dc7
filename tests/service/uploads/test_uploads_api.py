"""Outcomes of uploads, for programs."""

import httpx
import pytest

from tests.service.made_sessions import session_bytes, session_id

UPLOADS = "/api/v1/uploads"
pytestmark = pytest.mark.parametrize("databases", ["sqlite"], indirect=True)


def test_uploads_are_told_newest_first_with_what_became_of_them(client: httpx.Client) -> None:
    good = session_bytes()
    client.post("/api/v1/sessions", content=good)
    client.post("/api/v1/sessions", files={"file": ("bad.json", b'{"format": "imu-session/1"}')})
    refused, stored = client.get(UPLOADS).json()["uploads"]
    assert (stored["id"], stored["session"]["unit"], stored["problems"]) == (session_id(good), "BA-017", [])
    assert (refused["stored"], refused["session"], refused["filename"]) == (False, None, "bad.json")
    assert "sensors" in {fault["field"] for fault in refused["problems"]}
    assert [client.get(f"{UPLOADS}/{one['id']}").json() for one in (refused, stored)] == [refused, stored]
    assert client.get(UPLOADS, params={"refused": True}).json()["uploads"] == [refused]


def test_the_list_goes_on_where_the_last_answer_ended(client: httpx.Client) -> None:
    for name in ("first", "second", "third"):
        client.post("/api/v1/sessions", files={"file": (f"{name}.json", b"{}" + name.encode())})
    page = client.get(UPLOADS, params={"limit": 2}).json()
    rest = client.get(UPLOADS, params={"limit": 2, "after": page["next_after"]}).json()
    assert [one["filename"] for one in page["uploads"] + rest["uploads"]] == ["third.json", "second.json", "first.json"]
    assert rest["next_after"] is None


def test_an_upload_that_never_came_is_not_found(client: httpx.Client) -> None:
    assert [client.get(f"{UPLOADS}/{id}").status_code for id in ("r9", "0" * 20)] == [404, 404]
