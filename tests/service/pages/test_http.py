"""Pages over HTTP: headers, forms, error pages, static files, number of queries."""

import gzip
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from threading import current_thread

import httpx
import pytest
from fastapi import FastAPI
from sqlalchemy import event

from service.app import create_app
from service.settings import Settings
from service.web.assets import asset_url
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes
from tests.serving import http_client, limited_client, running

HTML = {"Accept": "text/html"}
MOST_QUERIES = 12
"""Most queries of the page of a session, which asks most: its content comes from as many tables."""


def post(client: httpx.Client, content: bytes, **headers: str) -> httpx.Response:
    return client.post("/upload", files={"files": ("BA-017.json", content)}, headers=HTML | headers)


@one_engine
@pytest.mark.parametrize("path", ["/", "/upload", "/units/none", "/api/v1/fleet"])
def test_nothing_foreign_may_run_or_frame(client: httpx.Client, path: str) -> None:
    policy = client.get(path, headers=HTML).headers["content-security-policy"]
    assert "default-src 'none'" in policy
    assert "frame-ancestors 'none'" in policy
    assert "unsafe" not in policy


@one_engine
@pytest.mark.parametrize("header", [{"Origin": "https://elsewhere.example"}, {"Sec-Fetch-Site": "cross-site"}])
def test_form_of_another_site_is_refused(client: httpx.Client, header: dict[str, str]) -> None:
    answer = post(client, session_bytes(), **header)
    assert answer.status_code == 403
    assert client.get("/api/v1/units").json()["units"] == []


def test_form_of_this_site_is_taken(client: httpx.Client) -> None:
    answer = post(client, session_bytes(), Origin=str(client.base_url).rstrip("/"))
    assert answer.status_code == 200
    assert "</span> Reference set<span" in answer.text
    assert "First session of this unit" in answer.text
    assert [u["serial"] for u in client.get("/api/v1/units").json()["units"]] == ["BA-017"]


def test_same_file_again_is_said_to_be_stored_before(client: httpx.Client) -> None:
    post(client, session_bytes())
    assert "already stored" in post(client, session_bytes()).text


@one_engine
def test_unusable_file_is_422_with_its_problems(client: httpx.Client) -> None:
    document = json.loads(session_bytes())
    document["table"]["A3"][6] = None
    answer = post(client, json.dumps(document).encode())
    assert answer.status_code == 422
    assert '<code>A3</code></td><td data-label="Row">7</td>' in answer.text


@one_engine
def test_upload_beyond_the_limit_is_refused(settings: Settings) -> None:
    with limited_client(settings, whole=1000, log=1000) as client:
        assert post(client, b" " * 200_000).status_code == 413


@pytest.mark.parametrize(("path", "status"), [("/units/none", 404), ("/sessions/none", 404), ("/?page=x", 422)])
def test_errors_are_pages_for_people_and_problems_for_programs(client: httpx.Client, path: str, status: int) -> None:
    page, problem = client.get(path, headers=HTML), client.get(path)
    assert (page.status_code, problem.status_code) == (status, status)
    assert page.headers["content-type"].startswith("text/html")
    assert '<section id="problem"' in page.text
    assert problem.headers["content-type"] == "application/problem+json"


@one_engine
def test_what_nobody_foresaw_is_a_page_too_and_says_nothing_of_the_inside(settings: Settings) -> None:
    app = create_app(settings)

    def fails() -> None:
        raise RuntimeError("inside")

    app.add_api_route("/fails", fails)
    with running(app) as address:  # which closes the connection after each
        page, problem = httpx.get(f"{address}/fails", headers=HTML), httpx.get(f"{address}/fails")
    assert (page.status_code, problem.status_code) == (500, 500)
    assert '<section id="problem"' in page.text
    assert "inside" not in page.text
    assert "default-src 'none'" in page.headers["content-security-policy"]
    assert problem.json()["status"] == 500


def test_page_without_database_says_when_to_come_back(tmp_path: Path) -> None:
    away = Settings(database_url="postgresql://nobody@127.0.0.1:1/none", data_folder=tmp_path)
    with http_client(create_app(away)) as client:
        answer = client.get("/", headers=HTML)
    assert answer.status_code == 503
    assert int(answer.headers["retry-after"]) > 0
    assert "Nothing was lost" in answer.text


@one_engine
def test_static_files_are_kept_for_a_year(client: httpx.Client) -> None:
    for name in ("style.css", "charts.js", "upload.js", "icon.svg", "vega.js"):
        answer = client.get(asset_url(name))
        assert answer.status_code == 200
        assert answer.headers["cache-control"] == "public, max-age=31536000, immutable"
    assert client.get("/static/style.css").status_code == 404


@one_engine
def test_static_files_come_compressed_and_plain(client: httpx.Client) -> None:
    packed = client.get(asset_url("style.css"), headers={"Accept-Encoding": "gzip"})
    plain = client.get(asset_url("style.css"), headers={"Accept-Encoding": "identity"})
    assert packed.headers["content-encoding"] == "gzip"
    assert packed.content == plain.content
    assert len(gzip.compress(plain.content)) < len(plain.content) / 2


@pytest.mark.parametrize("q", ["%00", "' OR 1=1 --", "%25", "_" * 200])
def test_any_search_text_is_only_text(client: httpx.Client, q: str) -> None:
    post(client, session_bytes())
    assert client.get(f"/?q={q}", headers=HTML).status_code in (200, 422)
    assert "BA-017" not in client.get(f"/?q={q}", headers=HTML).text


@contextmanager
def counted(app: FastAPI) -> Iterator[list[str]]:
    """The statements that an application sends to its database for requests, whatever works beside them."""
    engine = app.state.application.storage.database.engine
    statements: list[str] = []

    def note(_c: object, _k: object, statement: str, *_: object) -> None:
        if current_thread().name.startswith("AnyIO") and not statement.startswith("BEGIN"):
            statements.append(statement)

    event.listen(engine, "before_cursor_execute", note)
    yield statements
    event.remove(engine, "before_cursor_execute", note)


def asked(client: httpx.Client, path: str, statements: list[str]) -> Iterator[int]:
    """Number of queries of each of three looks at a page; the work beside the requests asks now and then too."""
    for _ in range(3):
        statements.clear()
        assert client.get(path, headers=HTML).status_code == 200
        yield len(statements)


def test_pages_ask_the_database_a_fixed_few_questions(settings: Settings) -> None:
    app = create_app(settings)
    with http_client(app) as client, counted(app) as statements:
        found: dict[str, set[int]] = {}
        client.post(
            "/api/v1/sessions", content=session_bytes(seed=9, started_at="2025-12-01T09:00:00Z")
        ).raise_for_status()
        for month in (1, 2, 3):
            id = client.post("/api/v1/sessions", content=session_bytes(month=month, seed=month)).json()["id"]
            for path in ("/", "/units/BA-017", f"/sessions/{id}"):
                found.setdefault(path.split("/")[1], set()).add(min(asked(client, path, statements)))
    assert all(len(counts) == 1 for counts in found.values()), found
    assert max(max(counts) for counts in found.values()) <= MOST_QUERIES, found


def test_the_fleet_page_leads_to_its_reports(client: httpx.Client) -> None:
    page = client.get("/").text
    for form in ("pdf", "xlsx"):
        address = f"/api/v1/fleet/report?format={form}"
        assert f'href="{address}"' in page
        assert client.get(address).status_code == 200
