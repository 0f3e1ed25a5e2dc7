"""A name that is not this service's own reaches nothing, and stands in no answer."""

import json

import httpx
import pytest
from pydantic import ValidationError

from service.settings import Settings
from service.web.hosts import hosts_of
from tests.service.made_sessions import session_bytes
from tests.service.web.conftest import At
from tests.service.web.raw import head, sent

FOREIGN = (
    "evil.example",
    "evil.example:8000",
    "127.0.0.1.evil.example",
    "localhost.evil.example",
    "10.1.2.3",
    "0.0.0.0",
)
MALFORMED = ("", "[", "[::1", "127.0.0.1:", "127.0.0.1:x", "a@127.0.0.1", "127.0.0.1/..", "127.0.0.1 evil", "ímu")
OWN = ("127.0.0.1", "127.0.0.1:9000", "localhost", "LOCALHOST:8000", "[::1]", "[::1]:8000")


@pytest.mark.parametrize("host", FOREIGN + MALFORMED)
def test_a_foreign_name_is_refused(at: At, host: str) -> None:
    found = sent(at(), head("GET", "/api/v1/units", Host=host))
    assert found.status in (400, 421)  # 400: no HTTP at all
    assert "evil" not in found.head + found.body.decode()


def test_every_refused_name_gets_the_one_shape(at: At) -> None:
    found = sent(at(), head("GET", "/nothing", Host="evil.example"))
    assert found.status == 421
    assert "content-type: application/problem+json" in found.head
    assert "IMU_HEALTH_ALLOWED_HOSTS" in json.loads(found.body)["detail"]


@pytest.mark.parametrize("host", ["evil.example", "[::1"])
def test_a_browser_gets_a_page(at: At, host: str) -> None:
    found = sent(at(), head("GET", "/", Host=host, Accept="text/html"))
    assert found.status == 421
    assert b'<section id="problem"' in found.body


def test_the_body_of_a_foreign_request_is_not_waited_for(at: At) -> None:
    found = sent(at(), head("POST", "/api/v1/sessions", Host="evil.example", Content_Length="1000000"))
    assert found.status == 421


@pytest.mark.parametrize("host", OWN)
def test_this_machine_s_own_names_are_taken(at: At, host: str) -> None:
    assert sent(at(), head("GET", "/healthz", Host=host)).status == 200


def test_http_1_0_need_not_name_a_host(at: At) -> None:
    assert sent(at(), b"GET /healthz HTTP/1.0\r\n\r\n").status == 200


def test_the_public_and_the_allowed_names_are_taken(at: At) -> None:
    address = at(public_url="https://imu.example.org/x", allowed_hosts=("inner:8000",))
    statuses = {
        host: httpx.get(f"{address}/healthz", headers={"Host": host}).status_code
        for host in ("imu.example.org", "IMU.example.org:443", "inner:8000", "inner:8001", "inner", "other.org")
    }
    assert [host for host, status in statuses.items() if status == 421] == ["inner:8001", "inner", "other.org"]


def test_under_the_public_name_links_lead_there(at: At) -> None:
    address = at(public_url="https://imu.example.org")
    named = httpx.post(f"{address}/api/v1/sessions", content=session_bytes(), headers={"Host": "imu.example.org"})
    assert named.headers["location"].startswith("https://imu.example.org/api/v1/sessions/")


def test_any_name_is_taken_where_the_operator_says_so(at: At) -> None:
    assert httpx.get(f"{at(allowed_hosts=('*',))}/healthz", headers={"Host": "any.example"}).status_code == 200


def test_a_service_that_others_reach_takes_addresses_but_no_names(at: At) -> None:
    address = at(host="0.0.0.0")
    for host, status in (("192.0.2.7:8000", 200), ("[2001:db8::7]", 200), ("evil.example", 421)):
        assert httpx.get(f"{address}/healthz", headers={"Host": host}).status_code == status, host


def test_a_service_that_knows_its_name_takes_its_own_address_but_no_other() -> None:
    hosts = hosts_of(Settings(host="0.0.0.0", public_url="https://imu.example.org"))
    assert hosts.allow("10.0.0.5:8000", local_address="10.0.0.5")
    assert hosts.allow("10.0.0.5:8000", local_address="::ffff:10.0.0.5")
    assert not hosts.allow("10.0.0.6:8000", local_address="10.0.0.5")


@pytest.mark.parametrize("url", ["https://[", "https://:80", "https:///x"])
def test_a_public_address_without_a_host_is_no_setting(url: str) -> None:
    with pytest.raises(ValidationError):
        Settings(public_url=url)


def test_names_are_set_by_a_list_with_commas(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IMU_HEALTH_ALLOWED_HOSTS", "a.example, b.example:8443")
    assert Settings().allowed_hosts == ("a.example", "b.example:8443")
