"""Pages of the fleet answer without waiting for its summaries where no process works beside the requests."""

from datetime import UTC, datetime
from functools import partialmethod
from time import monotonic

import pytest

from service.app import create_app
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.settings import Settings
from service.units.store import Units
from service.uploads.receive import upload
from service.work.readers import PAGE_PATIENCE, Reader
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes
from tests.serving import http_client
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
PAGES = ("/", "/due", "/stands", "/units/BA-017", "/api/v1/units", "/api/v1/stands", "/api/v1/fleet/due")


@pytest.fixture
def hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Pages are as impatient as they are in the service."""
    name = "until_summarised"
    monkeypatch.setattr(Reader, name, partialmethod(getattr(Reader, name), patience=PAGE_PATIENCE))


@pytest.mark.usefixtures("hurried")
def test_pages_answer_while_the_summaries_cannot_be_made(settings: Settings) -> None:
    """Nobody can store them while another writes: whoever made them for a page would wait for it."""
    with stores(settings) as storage, http_client(create_app(settings, lambda: NOW)) as client:
        upload(storage, session_bytes(), "a.json", NOW)
        with storage.database.writing() as store:
            Units(store).hold("BA-017")
            begun = monotonic()
            answers = {page: client.get(page).status_code for page in PAGES}
            taken = monotonic() - begun
    assert answers == dict.fromkeys(PAGES, 200)
    assert taken < settings.database_seconds


def test_the_service_makes_them_and_the_next_page_shows_them(settings: Settings) -> None:
    with stores(settings) as storage, http_client(create_app(settings, lambda: NOW)) as client:
        upload(storage, session_bytes(), "a.json", NOW)
        client.get("/stands").raise_for_status()
        with storage.database.reading() as store:
            assert not WorkQueue(store, WorkKind.SUMMARY).any_pending()
