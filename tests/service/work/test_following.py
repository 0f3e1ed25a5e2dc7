"""A page says that something is still being examined, and follows it by itself."""

import re
from datetime import UTC, datetime, timedelta

import httpx
import pytest

from service.app import create_app
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.settings import Settings
from service.uploads.receive import upload
from service.web.render import LATEST, SOONEST, follow_seconds
from service.work.kinds import LEASE
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes, session_id
from tests.service.pages.test_http import HTML
from tests.serving import http_client
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
CONTENT = session_bytes()
ID = session_id(CONTENT)


def shown(client: httpx.Client, path: str) -> str:
    return client.get(path, headers=HTML).text


@pytest.mark.parametrize(("age", "pause"), [(0, SOONEST), (20, 10), (3600, LATEST)])
def test_a_page_looks_again_ever_more_slowly(age: int, pause: int) -> None:
    assert follow_seconds(NOW, NOW + timedelta(seconds=age), workers=1) == pause


def test_where_nobody_makes_it_unasked_a_page_does_not_wait_for_it() -> None:
    assert follow_seconds(NOW, NOW, workers=0) is None


def test_a_session_that_is_diagnosed_is_not_followed(holding: Holding) -> None:
    client = holding(CONTENT, diagnosed=True)
    text = shown(client, f"/sessions/{ID}") + shown(client, f"/sessions/{ID}/outcome")
    assert "Nothing wrong found" in text
    assert "refresh" not in text
    assert "data-follow" not in text


@pytest.mark.usefixtures("patient_readers")
def test_session_and_card_follow_until_the_diagnosis_is_there(settings: Settings) -> None:
    with stores(settings) as storage:
        upload(storage, CONTENT, "a.json", NOW)
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.DIAGNOSIS).claim(ID, NOW, NOW + LEASE)
        with http_client(create_app(settings.model_copy(update={"diagnosis_workers": 1}), lambda: NOW)) as client:
            page, card = shown(client, f"/sessions/{ID}"), shown(client, f"/sessions/{ID}/outcome")
            with storage.database.writing() as store:
                WorkQueue(store, WorkKind.DIAGNOSIS).put_off(ID, None)
            client.get(f"/api/v1/sessions/{ID}/diagnosis").raise_for_status()
            later = shown(client, f"/sessions/{ID}/outcome")
    assert f'http-equiv="refresh" content="{SOONEST}"' in page
    assert f'data-follow="/sessions/{ID}/outcome"' in card
    assert all("Still being examined" in text for text in (page, card))
    assert "Nothing wrong found" in later
    assert "data-follow" not in later


PENDING = {"session": f"/sessions/{ID}", "diagnosis": f"/sessions/{ID}/diagnosis", "unit": "/units/BA-017"}


@pytest.mark.parametrize("page", PENDING)
def test_a_part_of_the_page_follows_with_scripts_and_the_page_without(settings: Settings, page: str) -> None:
    with stores(settings) as storage:
        upload(storage, CONTENT, "a.json", NOW)
        with storage.database.writing() as store:
            WorkQueue(store, WorkKind.DIAGNOSIS).claim(ID, NOW, NOW + LEASE)
            WorkQueue(store, WorkKind.OUTLOOK).claim("BA-017", NOW, NOW + LEASE)
        with http_client(create_app(settings.model_copy(update={"diagnosis_workers": 1}), lambda: NOW)) as client:
            text = shown(client, PENDING[page])
    assert re.search(r'<script type="module" src="[^"]*follow', text)
    assert re.search(r'<noscript><meta http-equiv="refresh" content="\d+"></noscript>', text)
    assert text.count(" data-follow=") == text.count('http-equiv="refresh"') == 1
