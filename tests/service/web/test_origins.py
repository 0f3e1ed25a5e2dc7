"""A page of another site changes nothing, whatever it asks for and however its browser names it."""

import httpx
import pytest

from tests.service.made_sessions import session_bytes
from tests.service.web.conftest import At
from tests.service.web.raw import head, sent

FOREIGN = (
    {"Origin": "https://elsewhere.example"},
    {"Origin": "null"},
    {"Origin": "http://["},
    {"Origin": ""},
    {"Origin": "http://127.0.0.1:1"},
    {"Sec-Fetch-Site": "cross-site"},
    {"Sec-Fetch-Site": "same-site"},
    {"Sec-Fetch-Site": "nonsense"},
)
CHANGES = (
    ("POST", "/api/v1/sessions"),
    ("POST", "/api/v1/units/BA-017/recalibrate"),
    ("PUT", "/api/v1/units/BA-017/lot"),
    ("DELETE", "/api/v1/webhooks/1"),
    ("PATCH", "/api/v1/units"),
    ("POST", "/upload"),
    ("POST", "/flags/1/resolve"),
    ("POST", "/nothing"),
)


@pytest.mark.parametrize("headers", FOREIGN, ids=str)
def test_a_session_of_another_site_is_refused_and_not_stored(at: At, headers: dict[str, str]) -> None:
    address = at()
    plain = {"Content-Type": "text/plain"} | headers
    answer = httpx.post(f"{address}/api/v1/sessions", content=session_bytes(), headers=plain)
    assert (answer.status_code, answer.headers["content-type"]) == (403, "application/problem+json")
    assert httpx.get(f"{address}/api/v1/units").json()["units"] == []


def test_every_change_is_refused(at: At) -> None:
    address = at()
    for method, path in CHANGES:
        answer = httpx.request(method, address + path, headers={"Sec-Fetch-Site": "cross-site"})
        assert answer.status_code == 403, path


def test_two_origins_are_refused_if_one_is_foreign(at: At) -> None:
    address = at()
    own = {"Host": address.removeprefix("http://"), "Origin": f"{address}\r\nOrigin: https://elsewhere.example"}
    assert sent(address, head("POST", "/api/v1/sessions", **own)).status == 403


def test_a_program_s_and_our_own_page_s_sessions_are_taken(at: At) -> None:
    address = at()
    for seed, headers in enumerate(({}, {"Origin": address, "Sec-Fetch-Site": "same-origin"})):
        answer = httpx.post(f"{address}/api/v1/sessions", content=session_bytes(seed=seed), headers=headers)
        assert answer.status_code == 201


def test_behind_a_proxy_that_names_itself_the_public_name_is_ours(at: At) -> None:
    address = at(public_url="https://imu.example.org")
    for origin, status in (("https://imu.example.org", 422), ("https://other.example.org", 403)):
        answer = httpx.post(f"{address}/api/v1/sessions", content=b"{}", headers={"Origin": origin})
        assert answer.status_code == status


def test_reads_are_for_our_own_pages_only_and_no_other_site_is_let_in(at: At) -> None:
    answer = httpx.get(f"{at()}/api/v1/units", headers={"Origin": "https://elsewhere.example"})
    assert answer.headers["cross-origin-resource-policy"] == "same-origin"
    assert [name for name in answer.headers if name.startswith("access-control")] == []
