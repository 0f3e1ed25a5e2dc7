"""Limits on password attempts: one for all processes on a database, whoever asks at once; and whoever guesses keeps
nobody else out.
"""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from ipaddress import ip_network

import httpx
import pytest

from service.app import create_app
from service.errors import SignInError, TooOftenError
from service.people.admission import browser_of, cookie_of, counted_address
from service.people.changes import (
    ADDRESS_LIMIT,
    DAILY_LIMIT,
    DAILY_LIMIT_OF_ALL,
    LOGIN_LIMIT,
    SignInAttempt,
    attempting,
)
from service.settings import Settings
from service.storage import Storage
from tests.databases import one_engine
from tests.service.people.staff import NOW, PASSWORD, staffed, with_password
from tests.serving import http_client
from tests.stock import stores

ATTEMPT = SignInAttempt("k.ito", "203.0.113.9")


def was_looked_at(storage: Storage, attempt: SignInAttempt = ATTEMPT, *, right: bool = False, later: float = 0) -> bool:
    """Whether a password got as far as being checked."""
    try:
        with attempting(storage, attempt, NOW + timedelta(seconds=later)):
            if not right:
                raise SignInError("wrong")
    except SignInError:
        return True
    except TooOftenError:
        return False
    return True


def test_two_services_on_one_database_count_together(settings: Settings) -> None:
    with stores(settings) as one, stores(settings) as other:
        looked_at = [was_looked_at(storage) for _ in range(LOGIN_LIMIT) for storage in (one, other)]
    assert looked_at == [True] * LOGIN_LIMIT + [False] * LOGIN_LIMIT


def test_of_many_at_once_no_more_get_through(storage: Storage) -> None:
    with ThreadPoolExecutor(12) as pool:
        assert sum(pool.map(lambda _: was_looked_at(storage), range(24))) == LOGIN_LIMIT


def test_after_a_minute_one_may_try_again(storage: Storage) -> None:
    assert [was_looked_at(storage, later=10 * k) for k in range(8)] == [True] * 5 + [False, True, True]


def test_one_password_tried_on_everybody_ends_by_the_address(storage: Storage) -> None:
    tried = [was_looked_at(storage, SignInAttempt(f"user{k}", "203.0.113.9")) for k in range(ADDRESS_LIMIT + 5)]
    assert sum(tried) == ADDRESS_LIMIT
    assert was_looked_at(storage, SignInAttempt("user99", "203.0.113.10"))


def test_the_right_one_forgets_the_wrong_ones(storage: Storage) -> None:
    for _ in range(3):
        assert all(was_looked_at(storage) for _ in range(LOGIN_LIMIT - 1))
        assert was_looked_at(storage, right=True)


def test_what_is_refused_for_another_reason_is_no_wrong_attempt(storage: Storage) -> None:
    for _ in range(2 * LOGIN_LIMIT):
        with pytest.raises(ValueError, match="too short"), attempting(storage, ATTEMPT, NOW):
            raise ValueError("too short")


def test_many_addresses_get_no_further_at_one_account_than_the_day_s_bound(storage: Storage) -> None:
    addresses = [f"203.0.113.{k}" for k in range(DAILY_LIMIT_OF_ALL // 4)]
    tried = [was_looked_at(storage, SignInAttempt("k.ito", one)) for one in addresses for _ in range(LOGIN_LIMIT)]
    assert sum(tried) == DAILY_LIMIT_OF_ALL
    assert not was_looked_at(storage, SignInAttempt("k.ito", "198.51.100.1"), later=3600)
    assert was_looked_at(storage, SignInAttempt("k.ito", "198.51.100.1", browser="known"), later=3600)
    assert was_looked_at(storage, SignInAttempt("m.okafor", "198.51.100.1"), later=3600)
    assert was_looked_at(storage, SignInAttempt("k.ito", "198.51.100.1"), later=24 * 3600 + 61)


def test_one_address_does_not_use_up_the_day_of_all(storage: Storage) -> None:
    tried = [was_looked_at(storage, later=61 * k) for k in range(2 * DAILY_LIMIT_OF_ALL)]
    assert sum(tried) == DAILY_LIMIT
    assert was_looked_at(storage, SignInAttempt("k.ito", "198.51.100.1"), later=61)


@pytest.fixture
def gateway(settings: Settings, storage: Storage) -> Iterator[httpx.Client]:
    """A service behind a proxy at this address, which it trusts; engineer and crew have passwords."""
    staffed(storage)
    for login in ("engineer", "crew"):
        with_password(storage, login)
    behind = settings.model_copy(update={"trusted_proxies": (ip_network("127.0.0.0/8"),)})
    with http_client(create_app(behind, clock=lambda: NOW)) as client:
        yield client


def entered(client: httpx.Client, address: str, password: str = PASSWORD, login: str = "engineer") -> int:
    """Status of a sign-in, in a browser without any cookie but those of this client."""
    data, headers = {"login": login, "password": password}, {"X-Forwarded-For": address}
    return client.post("/sign-in", data=data, headers=headers).status_code


def guess(client: httpx.Client, address: str, times: int = LOGIN_LIMIT + 1) -> int:
    """Status of the last of some wrong guesses; the browser keeps no cookie."""
    with httpx.Client(base_url=client.base_url) as other:
        return [entered(other, address, f"guess {k} of many") for k in range(times)][-1]


def test_who_guesses_keeps_nobody_out_but_themselves(gateway: httpx.Client) -> None:
    assert guess(gateway, "203.0.113.9") == 429
    assert entered(gateway, "203.0.113.9") == 429
    assert entered(gateway, "198.51.100.1") == 303


def test_a_browser_that_has_signed_in_before_passes_and_has_its_own_count(gateway: httpx.Client) -> None:
    assert entered(gateway, "203.0.113.9") == 303
    gateway.post("/sign-out")
    assert guess(gateway, "203.0.113.9") == 429
    assert entered(gateway, "203.0.113.9") == 303
    assert [entered(gateway, "203.0.113.9", f"guess {k} of many") for k in range(6)] == [401] * 5 + [429]
    assert entered(gateway, "198.51.100.1", login="crew") == 303


def test_what_a_browser_keeps_opens_nothing_and_is_of_one_account_and_password(gateway: httpx.Client) -> None:
    assert entered(gateway, "203.0.113.9") == 303
    (name,) = (one for one in gateway.cookies if one.startswith("imu-health-known-"))
    proof = gateway.cookies[name]
    with httpx.Client(base_url=gateway.base_url) as other:
        other.cookies.set(name, proof)
        assert other.get("/api/v1/me").status_code == 401
    assert browser_of(proof, "Engineer ", None, NOW) == ""
    with httpx.Client(base_url=gateway.base_url) as forger:
        forger.cookies.set(cookie_of("crew"), proof)
        assert [entered(forger, "203.0.113.7", f"guess {k}", "crew") for k in range(6)] == [401] * 5 + [429]
        assert guess_as(gateway, "crew", "203.0.113.7") == 429


def guess_as(client: httpx.Client, login: str, address: str) -> int:
    """Status of a sign-in with the right password from an address, in a browser without cookies."""
    with httpx.Client(base_url=client.base_url) as other:
        return entered(other, address, login=login)


def test_without_the_setting_nobody_says_where_they_come_from(settings: Settings, storage: Storage) -> None:
    staffed(storage)
    with_password(storage, "engineer")
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        tried = [entered(client, f"203.0.113.{k}", f"guess {k} of many") for k in range(LOGIN_LIMIT + 1)]
    assert tried == [401] * LOGIN_LIMIT + [429]


@one_engine
@pytest.mark.parametrize(
    ("forwarded", "counted"),
    [("203.0.113.{}", False), ("198.51.100.{}, 203.0.113.9", True), ("198.51.100.{}, 203.0.113.9, 127.0.0.2", True)],
)
def test_only_what_a_trusted_proxy_wrote_is_believed(gateway: httpx.Client, forwarded: str, counted: bool) -> None:
    tried = [entered(gateway, forwarded.format(k), f"guess {k} of many") for k in range(LOGIN_LIMIT + 1)]
    assert (tried[-1] == 429) is counted


@pytest.mark.parametrize(
    ("client", "counted"),
    [
        ("203.0.113.9", "203.0.113.9"),
        ("2001:db8::1", "2001:db8::/64"),
        ("2001:db8::ffff:2", "2001:db8::/64"),
        ("::ffff:203.0.113.9", "203.0.113.9"),
        ("testclient", "testclient"),
    ],
)
def test_a_site_counts_as_one_address(client: str, counted: str) -> None:
    assert counted_address(client) == counted
