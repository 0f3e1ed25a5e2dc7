"""A page asks the database eleven questions at most, who asks among them."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime

import httpx
import pytest
from sqlalchemy import Engine, event

from service.records.diagnose import diagnose
from service.storage import Storage
from service.uploads.receive import upload
from tests.service.made_sessions import session_bytes
from tests.service.uploads.test_questioned_page import in_mv

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
MOST = 13
HTML = {"Accept": "text/html"}
UNIT = "BA-017"
SERVICE = {"at": "2026-02-10T09:00:00Z", "kind": "repair", "note": "", "by": "K. Ito"}


@contextmanager
def asked() -> Iterator[list[str]]:
    """The statements of requests; threads beside them have theirs."""
    statements: list[str] = []

    def note(_c: object, _k: object, statement: str, *_: object) -> None:
        if threading.current_thread().name.startswith("AnyIO") and not statement.startswith("BEGIN"):
            statements.append(statement)

    event.listen(Engine, "before_cursor_execute", note)
    yield statements
    event.remove(Engine, "before_cursor_execute", note)


@pytest.fixture
def pages(storage: Storage, client: httpx.Client) -> dict[str, str]:
    """Addresses of pages with something in every section that has a question of its own."""
    months = {1: {"stage": "as-found"}, 2: {"stage": "as-left"}, 3: {}}
    contents = [
        session_bytes(unit=UNIT, seed=month, started_at=f"2026-0{month}-01T09:00:00Z", **own)
        for month, own in months.items()
    ]
    ids = [upload(storage, content, "a.json", NOW).id for content in contents]
    diagnose(storage, ids[-1], NOW)
    number = client.post(f"/api/v1/units/{UNIT}/services", json=SERVICE).json()["id"]
    client.post(f"/api/v1/services/{number}/withdraw", json={"by": "K. Ito", "why": "another unit"}).raise_for_status()
    doubtful = upload(storage, in_mv(UNIT), "a.json", NOW).id
    return {
        "fleet": "/", "unit": f"/units/{UNIT}", "session": f"/sessions/{ids[-1]}",
        "questioned session": f"/sessions/{doubtful}",
    }  # fmt: skip


def test_a_page_asks_a_few_questions(client: httpx.Client, pages: dict[str, str]) -> None:
    for name, page in pages.items():
        client.get(page, headers=HTML)
        with asked() as statements:
            assert client.get(page, headers=HTML).status_code == 200
        assert 0 < len(statements) <= MOST, name
