"""Somebody always administers: also when two take it from each other at the same moment."""

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from datetime import timedelta

import httpx
import pytest
from sqlalchemy import Connection

from service.app import create_app
from service.kit.person import Role
from service.people.changes import AccountChange, change_account, make_token
from service.people.store import Accounts, Tokens
from service.settings import Settings
from service.storage import Storage
from service.storage.audit import LOCK
from tests.databases import Databases, PostgresDatabases
from tests.databases import all_on_both_engines as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.people.staff import NOW, Staff, staffed
from tests.serving import http_client

WAITING = "SELECT count(DISTINCT pid) FROM pg_locks WHERE NOT granted"


@pytest.fixture
def staff(storage: Storage) -> Staff:
    """Two administrators: the second one was an engineer."""
    found = staffed(storage)
    change_account(storage, "engineer", AccountChange(role=Role.ADMIN), NOW, who="test")
    return found


def admin_headers(storage: Storage, login: str) -> dict[str, str]:
    """Headers of a new token that may do everything; it was used already, so that showing it writes nothing."""
    token, secret = make_token(storage, login, "bench", Role.ADMIN, NOW, lifetime=timedelta(days=1), who="test")
    with storage.database.writing() as store:
        Tokens(store).used(token.id, NOW)
    return {"Authorization": f"Bearer {secret}"}


@contextmanager
def nobody_commits(storage: Storage, *, is_postgresql: bool) -> Iterator[Connection]:
    """The audit trail's lock, the last thing that a transaction of PostgreSQL asks for, is held; SQLite has one writer
    at a time anyway."""
    with storage.database.engine.connect() as other:
        if is_postgresql:
            other.exec_driver_sql(f"SELECT pg_advisory_xact_lock({LOCK})")
        yield other
        other.rollback()


@pytest.mark.parametrize(("change", "late"), [({"role": "viewer"}, 403), ({"is_active": False}, 401)])
def test_of_two_administrators_who_demote_each_other_one_is_left(
    settings: Settings, storage: Storage, staff: Staff, databases: Databases, change: dict[str, object], late: int
) -> None:
    """``late``: the second's answer on SQLite whose account was changed before anybody looked who it is."""
    tokens = {other: admin_headers(storage, who) for who, other in (("admin", "engineer"), ("engineer", "admin"))}

    def demote(client: httpx.Client, other: str) -> int:
        return client.put(f"/api/v1/accounts/{other}", json=change, headers=tokens[other]).status_code

    is_postgresql = isinstance(databases, PostgresDatabases)
    with http_client(create_app(settings, clock=lambda: NOW)) as client, ThreadPoolExecutor(2) as pool:
        with nobody_commits(storage, is_postgresql=is_postgresql) as other:
            answers = [pool.submit(demote, client, one) for one in tokens]
            while is_postgresql and other.exec_driver_sql(WAITING).scalar_one() < 2:
                assert not any(one.done() for one in answers), "one ended although nobody can commit"
        rejected = {409} if is_postgresql else {late, 409}
        first, second = sorted(one.result() for one in answers)
        assert first == 200
        assert second in rejected
    with storage.database.reading() as store:
        assert Accounts(store).admins() == 1
