"""Somebody signs in at a provider: over real HTTP, and with everything that could be forged on the way."""

import base64
import hmac
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs, urlsplit

import httpx
import pytest

from service.app import create_app
from service.errors import ServiceError
from service.people.changes import AccountChange, change_account
from service.people.sign_in_elsewhere import connect
from service.settings import Settings
from service.storage import Storage
from service.storage.audit import Audit
from tests.databases import ENGINES
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.people.provider import CLIENT, SECRET, OpenId, made_key, plain64, provider
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import http_client

PAGE = {"Accept": "text/html"}
ROLES = (("imu-crew", "crew"), ("imu-leads", "engineer"))
EVERYBODY = ("*", "viewer")
both = pytest.mark.parametrize("databases", ENGINES, indirect=True)


@pytest.fixture
def openid() -> Iterator[OpenId]:
    with provider(int(NOW.timestamp())) as found:
        yield found


@pytest.fixture
def staff(storage: Storage) -> Staff:
    return staffed(storage)


@pytest.fixture
def known(settings: Settings, openid: OpenId, tmp_path: Path) -> Settings:
    """A service that knows the provider."""
    (tmp_path / "secret").write_text(SECRET + "\n")
    own = {"oidc_issuer": openid.issuer, "oidc_client_id": CLIENT, "oidc_client_secret_file": tmp_path / "secret"}
    return settings.model_copy(update=own | {"oidc_roles": (EVERYBODY,)})


@pytest.fixture
def http(known: Settings, staff: Staff) -> Iterator[httpx.Client]:
    """A browser."""
    with http_client(create_app(known, clock=lambda: NOW)) as client:
        client.headers.update(PAGE)
        yield client


def sent_there(http: httpx.Client, next: str = "/flags") -> str:
    """Address that the provider sends the browser back to, once it was sent there."""
    began = http.get("/oidc/start", params={"next": next})
    assert began.status_code == 303, began.text
    return httpx.get(began.headers["location"]).headers["location"]


def entered(http: httpx.Client) -> httpx.Response:
    """All of the way."""
    return http.get(sent_there(http))


def me(http: httpx.Client) -> dict[str, Any]:
    found: dict[str, Any] = http.get("/api/v1/me", headers={"Accept": "application/json"}).json()
    return found


@both
def test_somebody_signs_in_and_out_and_in_again_as_the_same(http: httpx.Client, storage: Storage) -> None:
    for _ in range(2):
        answer = entered(http)
        assert (answer.status_code, answer.headers["location"]) == (303, "/flags"), answer.text
        assert (me(http)["login"], me(http)["name"], me(http)["role"]) == ("k.ito", "K. Ito", "viewer")
        assert http.post("/sign-out").status_code == 303
        assert http.get("/flags").status_code == 303
    with storage.database.reading() as store:
        lines = [(line.action, line.subject) for line in Audit(store).page(5)]
    assert lines == [(action, "k.ito") for action in ("sign out", "sign in", "sign out", "sign in", "add account")]


def test_the_page_has_the_button_only_where_a_provider_is_set(http: httpx.Client, settings: Settings) -> None:
    assert 'href="/oidc/start?next=/flags">Sign in with 127.0.0.1' in http.get("/sign-in?next=/flags").text
    with http_client(create_app(settings, clock=lambda: NOW)) as without:
        assert "oidc" not in without.get("/sign-in").text
        assert without.get("/oidc/start").status_code == 404
        assert without.get("/oidc/callback?code=x&state=y").status_code == 404


def test_a_login_that_is_taken_is_another_person_s(http: httpx.Client, openid: OpenId) -> None:
    openid.person["preferred_username"] = "admin"
    entered(http)
    assert (me(http)["login"], me(http)["role"]) == ("admin-2", "viewer")


@pytest.mark.parametrize("claimed", ["../../Ünï cødé", "@@@", "x" * 300, "a@b.example"])
def test_any_name_becomes_a_login(http: httpx.Client, openid: OpenId, claimed: str) -> None:
    openid.person["preferred_username"] = claimed
    assert entered(http).status_code == 303
    assert 0 < len(me(http)["login"]) <= 60


def forged(change: Callable[[dict[str, Any]], dict[str, Any]]) -> Callable[[str], str]:
    """A token whose claims were changed after it was signed."""

    def of(token: str) -> str:
        head, body, seal = token.split(".")
        claims = json.loads(base64_of(body))
        return ".".join((head, plain64(json.dumps(change(claims)).encode()), seal))

    return of


def base64_of(text: str) -> bytes:
    return base64.urlsafe_b64decode(text + "=" * (-len(text) % 4))


def headed(algorithm: str, token: str) -> str:
    """Head and body of a token that says of itself how it is signed."""
    head = plain64(json.dumps({"alg": algorithm, "typ": "JWT"}).encode())
    return f"{head}.{token.split('.')[1]}"


def unsigned(token: str) -> str:
    return f"{headed('none', token)}."


def with_a_shared_key(token: str) -> str:
    """Signed with a secret that both sides have, which a stolen file would tell."""
    text = headed("HS256", token)
    return f"{text}.{plain64(hmac.digest(SECRET.encode(), text.encode(), 'sha256'))}"


CLAIMS: dict[str, dict[str, Any]] = {
    "expired": {"exp": int(NOW.timestamp()) - 3600},
    "of the future": {"iat": int(NOW.timestamp()) + 3600},
    "for another program": {"aud": "another"},
    "for several, by another": {"aud": [CLIENT, "another"], "azp": "another"},
    "for several, by nobody": {"aud": [CLIENT, "another"]},
    "of another issuer": {"iss": "https://evil.example"},
    "of another sign-in": {"nonce": "0" * 64},
    "of nobody": {"sub": ""},
    "of a number": {"sub": 7},
    "without end": {"exp": None},
}


@pytest.mark.parametrize("lie", CLAIMS)
def test_a_token_that_is_not_ours_opens_nothing(http: httpx.Client, openid: OpenId, lie: str) -> None:
    openid.claims = lambda claims: claims | CLAIMS[lie]
    answer = entered(http)
    assert (answer.status_code, "was not accepted" in answer.text) == (401, True)
    assert http.get("/flags").status_code == 303


@pytest.mark.parametrize("lie", [forged(lambda c: c | {"sub": "other"}), unsigned, with_a_shared_key, lambda _: "x.y"])
def test_a_forged_token_opens_nothing(http: httpx.Client, openid: OpenId, lie: Callable[[str], str]) -> None:
    openid.token = lie
    assert entered(http).status_code == 401
    assert http.get("/flags").status_code == 303


def test_a_token_of_a_key_that_was_taken_back_opens_nothing(http: httpx.Client, openid: OpenId) -> None:
    other = OpenId(openid.now, openid.issuer, key=made_key(2))
    openid.token = lambda token: other.signed(json.loads(base64_of(token.split(".")[1]))["nonce"])
    assert entered(http).status_code == 401


def changed(address: str, **query: str | None) -> str:
    """The way back with something else in its query."""
    parts = urlsplit(address)
    asked = {k: v[0] for k, v in parse_qs(parts.query).items()} | query
    return str(httpx.URL(parts._replace(query="").geturl(), params={k: v for k, v in asked.items() if v is not None}))


@pytest.mark.parametrize(
    "query",
    [{"state": "0" * 64}, {"state": None}, {"code": "code-99"}, {"code": None}, {"iss": "https://evil.example"}],
)
def test_what_comes_back_must_answer_what_was_asked(http: httpx.Client, query: dict[str, str | None]) -> None:
    assert http.get(changed(sent_there(http), **query)).status_code == 401
    assert http.get("/flags").status_code == 303


def test_a_way_back_works_in_its_own_browser_and_once(http: httpx.Client, known: Settings) -> None:
    """Nobody can sign somebody else in as themselves, nor use a way back that they saw."""
    back = sent_there(http)
    with httpx.Client(base_url=http.base_url, headers=PAGE) as other:
        assert other.get(back).status_code == 401
        other.get("/oidc/start")
        assert other.get(back).status_code == 401
    held = http.cookies["imu-health-oidc"]
    assert http.get(back).status_code == 303
    http.cookies.set("imu-health-oidc", held, domain="127.0.0.1", path="/oidc")
    assert http.get(back).status_code == 401


@pytest.mark.parametrize(
    "lie",
    [
        {"issuer": "https://evil.example"},
        {"token_endpoint": "http://169.254.169.254/latest"},
        {"jwks_uri": "http://127.0.0.1:1/keys"},
        {"authorization_endpoint": "file:///etc/passwd"},
    ],
)
def test_a_provider_cannot_send_the_service_elsewhere(http: httpx.Client, openid: OpenId, lie: dict[str, str]) -> None:
    back = None if "authorization_endpoint" in lie or "issuer" in lie else sent_there(http)
    openid.description = lie
    answer = http.get("/oidc/start") if back is None else http.get(back)
    assert (answer.status_code, "does not answer as it should" in answer.text) == (503, True)


def test_a_provider_that_is_away_is_said(http: httpx.Client, known: Settings, staff: Staff) -> None:
    gone = known.model_copy(update={"oidc_issuer": "http://127.0.0.1:9"})
    with http_client(create_app(gone)) as client:
        assert client.get("/oidc/start").status_code == 503


def test_the_way_back_leads_nowhere_else(http: httpx.Client) -> None:
    assert http.get(sent_there(http, "https://evil.example")).headers["location"] == "/"


def by_claim(known: Settings, **changes: Any) -> Settings:
    """The provider says the roles."""
    return known.model_copy(update={"oidc_role_claim": "groups", "oidc_roles": ROLES} | changes)


def test_the_provider_s_groups_give_the_role_at_every_sign_in(
    known: Settings, staff: Staff, openid: OpenId, storage: Storage
) -> None:
    with http_client(create_app(by_claim(known), clock=lambda: NOW)) as http:
        for groups, role in ((["imu-crew", "imu-leads", "x"], "engineer"), ("imu-crew", "crew")):
            openid.person["groups"] = groups
            assert entered(http).status_code == 303
            assert me(http)["role"] == role
        openid.person["groups"] = ["something else"]
        assert entered(http).status_code == 403
    with storage.database.reading() as store:
        assert Audit(store).page(2)[1].details["before"] == {"role": "engineer"}


def test_where_everybody_may_have_an_account_one_without_a_role_is_a_viewer(
    known: Settings, staff: Staff, openid: OpenId
) -> None:
    with http_client(create_app(by_claim(known, oidc_roles=(*ROLES, EVERYBODY)), clock=lambda: NOW)) as http:
        for groups, role in ((["imu-crew"], "crew"), ([], "viewer")):
            openid.person["groups"] = groups
            assert entered(http).status_code == 303
            assert me(http)["role"] == role


def test_nobody_is_made_whom_the_operator_did_not_let_in(known: Settings, staff: Staff, storage: Storage) -> None:
    own = known.model_copy(update={"oidc_roles": ()})
    with http_client(create_app(own, clock=lambda: NOW)) as http:
        assert entered(http).status_code == 403
        connect(storage, "crew", own.oidc_issuer, "248289761001", NOW, who="test")
        assert entered(http).status_code == 303
        assert me(http)["login"] == "crew"


def test_the_first_account_is_no_stranger_s(known: Settings) -> None:
    required = known.model_copy(update={"sign_in": "required"})
    with http_client(create_app(required, clock=lambda: NOW)) as http:
        answer = entered(http)
    assert (answer.status_code, "first one must be an admin" in answer.text) == (409, True)


def test_who_may_no_longer_sign_in_stays_out(http: httpx.Client, storage: Storage) -> None:
    entered(http)
    change_account(storage, "k.ito", AccountChange(is_active=False), NOW, who="test")
    assert entered(http).status_code == 401
    assert http.get("/flags").status_code == 303


@pytest.mark.parametrize(
    "changes",
    [{"oidc_issuer": "http://login.example.org"}, {"oidc_client_id": ""}, {"oidc_client_secret_file": Path("x")}],
)
def test_a_provider_that_cannot_be_used_is_said_at_the_start(known: Settings, changes: dict[str, Any]) -> None:
    with pytest.raises(ServiceError):
        create_app(known.model_copy(update=changes))


def test_roles_are_written_as_pairs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("IMU_HEALTH_OIDC_ROLES", "cn=imu=crew, leads=engineer")
    assert Settings().oidc_roles == (("cn=imu", "crew"), ("leads", "engineer"))
