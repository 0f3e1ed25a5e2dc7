"""Tokens: what they open, how they end, and whose name stands under what they did."""

from datetime import timedelta

import httpx
import pytest

from service.app import create_app
from service.errors import ConflictError, RefusedError
from service.kit.person import EVERYBODY, Role
from service.people.changes import AccountChange, change_account, make_token, revoke_token
from service.settings import Settings
from service.storage import Storage
from tests.service.made_sessions import session_bytes
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import http_client

DAY = timedelta(days=1)


@pytest.fixture
def staff(storage: Storage) -> Staff:
    """One of every role."""
    return staffed(storage)


def opens(settings: Settings, secret: str, later: timedelta = timedelta(0)) -> int:
    """Status of a request with a token, some time later."""
    with http_client(create_app(settings, clock=lambda: NOW + later)) as client:
        return client.get("/api/v1/units", headers={"Authorization": f"Bearer {secret}"}).status_code


def made(storage: Storage, role: Role = Role.VIEWER, lasts: timedelta = DAY) -> tuple[int, str]:
    token, secret = make_token(storage, "engineer", "bench", role, NOW, lifetime=lasts, who="test")
    return token.id, secret


def test_a_token_ends_by_itself(settings: Settings, storage: Storage, staff: Staff) -> None:
    _, secret = made(storage)
    assert [opens(settings, secret, later) for later in (timedelta(0), DAY, 2 * DAY)] == [200, 401, 401]


def test_a_revoked_token_opens_nothing(settings: Settings, storage: Storage, staff: Staff) -> None:
    id, secret = made(storage)
    assert revoke_token(storage, id, EVERYBODY, NOW, who="test").revoked_at == NOW
    assert opens(settings, secret) == 401


def test_a_token_of_an_account_that_may_no_longer_sign_in_opens_nothing(
    settings: Settings, storage: Storage, staff: Staff
) -> None:
    _, secret = made(storage)
    change_account(storage, "engineer", AccountChange(is_active=False), NOW, who="test")
    assert opens(settings, secret) == 401


def test_a_forged_token_opens_nothing(settings: Settings, storage: Storage, staff: Staff) -> None:
    _, secret = made(storage)
    assert opens(settings, secret[:-1] + ("a" if secret[-1] != "a" else "b")) == 401
    assert opens(settings, "imuh_") == 401


def test_a_token_may_no_more_than_its_account(settings: Settings, storage: Storage, staff: Staff) -> None:
    with pytest.raises(ConflictError, match="engineer is engineer"):
        made(storage, Role.ADMIN)
    _, secret = made(storage, Role.ENGINEER)
    change_account(storage, "engineer", AccountChange(role=Role.VIEWER), NOW, who="test")
    headers = {"Authorization": f"Bearer {secret}"}
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        assert client.get("/api/v1/me", headers=headers).json()["role"] == "viewer"


def test_a_token_that_holds_for_ever_is_refused(storage: Storage, staff: Staff) -> None:
    with pytest.raises(RefusedError, match="cannot be made"):
        made(storage, lasts=timedelta(days=1000))


def test_a_token_makes_none_that_may_more(settings: Settings, storage: Storage, staff: Staff) -> None:
    _, secret = made(storage, Role.VIEWER)
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        new = {"label": "more", "role": "engineer"}
        headers = {"Authorization": f"Bearer {secret}"}
        assert client.post("/api/v1/tokens", json=new, headers=headers).status_code == 403


def test_of_the_secret_nothing_is_stored(storage: Storage, staff: Staff) -> None:
    _, secret = made(storage)
    with storage.database.engine.connect() as connection:
        kept = connection.exec_driver_sql("SELECT * FROM tokens").all()
    assert len(kept) == 5
    assert not any(secret in str(row) or secret[5:] in str(row) for row in kept)


def test_what_is_done_bears_the_account_s_name_whatever_is_claimed(settings: Settings, staff: Staff) -> None:
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        upload = client.post("/api/v1/sessions", content=session_bytes(), headers=staff.headers(Role.CREW))
        id = upload.json()["id"]
        claimed = {"by": "The Director", "why": "cable"}
        client.post(f"/api/v1/sessions/{id}/withdraw", json=claimed, headers=staff.headers(Role.ENGINEER))
        lines = audit(client, staff, id)
    assert [(line["who"], line["account"], line["action"]) for line in lines[:1]] == [
        ("Engineer", "engineer, token bench", "withdraw session")
    ]
    assert ("Crew", "upload") in {(line["who"], line["action"]) for line in lines}


def audit(client: httpx.Client, staff: Staff, subject: str) -> list[dict[str, str]]:
    """The lines of a subject, newest first."""
    answer = client.get("/api/v1/audit", params={"subject": subject}, headers=staff.headers(Role.ADMIN))
    lines: list[dict[str, str]] = answer.json()["lines"]
    return lines


def test_only_an_engineer_replaces_a_session(settings: Settings, staff: Staff) -> None:
    with http_client(create_app(settings, clock=lambda: NOW)) as client:
        first = client.post("/api/v1/sessions", content=session_bytes(), headers=staff.headers(Role.CREW)).json()["id"]
        instead = {"supersedes": first, "why": "typing error"}
        content = session_bytes(seed=2)
        for role, status in ((Role.CREW, 403), (Role.ENGINEER, 201)):
            sent = client.post("/api/v1/sessions", params=instead, content=content, headers=staff.headers(role))
            assert sent.status_code == status, sent.text
