"""The service as operators see it: requests by their id, and a disk that is filling up."""

import httpx
import pytest

from tests.service.made_sessions import session_bytes
from tests.service.web.conftest import At
from tests.service.web.raw import head, sent

MORE_THAN_ANY_DISK = 10**18


def test_a_problem_names_the_request(at: At) -> None:
    answer = httpx.get(f"{at()}/nothing", headers={"X-Request-ID": "from-the-caller.7"})
    assert (answer.headers["x-request-id"], answer.json()["request_id"]) == ("from-the-caller.7",) * 2


def test_a_page_of_a_problem_names_the_request_too(at: At) -> None:
    headers = {"X-Request-ID": "from-the-caller.7", "Accept": "text/html"}
    assert "Request <code>from-the-caller.7</code>" in httpx.get(f"{at()}/nothing", headers=headers).text


@pytest.mark.parametrize("id", ["a b", "x" * 65, "{}", "a;b", "é", '"', ""])
def test_an_id_that_could_be_taken_for_something_else_is_replaced(at: At, id: str) -> None:
    found = sent(at(), head("GET", "/nothing", X_Request_ID=id))
    assert f"x-request-id: {id.lower()}\r" not in found.head
    assert "x-request-id: " in found.head


@pytest.mark.parametrize("headers", [{"Host": "evil.example"}, {"Origin": "null"}, {"Content-Length": "999999999"}])
def test_what_is_refused_before_any_route_has_an_id_too(at: At, headers: dict[str, str]) -> None:
    answer = sent(at(), head("PUT", "/nothing", **{name.replace("-", "_"): value for name, value in headers.items()}))
    assert answer.status in (403, 413, 421)
    assert b'"request_id":"' in answer.body


def test_a_disk_that_is_filling_up_takes_no_uploads_but_shows_what_is_there(at: At) -> None:
    address = at({"free": MORE_THAN_ANY_DISK})
    for answer in (
        httpx.post(f"{address}/api/v1/sessions", content=session_bytes()),
        httpx.post(f"{address}/upload", files={"files": ("a.json", session_bytes())}),
    ):
        assert (answer.status_code, answer.headers["content-type"]) == (507, "application/problem+json")
    assert httpx.get(f"{address}/api/v1/units").json()["units"] == []
    ready = httpx.get(f"{address}/readyz")
    assert (ready.status_code, ready.json()["status"]) == (200, "degraded")
    assert "MiB left" in ready.json()["reasons"][0]


def test_the_room_that_is_left_is_a_figure(at: At) -> None:
    figures = httpx.get(f"{at()}/metrics").text
    free = float(figures.split("\nimu_health_free_bytes ")[1].split("\n")[0])
    assert free > 0
