"""Names that try to be paths or headers."""

from pathlib import Path

import httpx
import pytest

from service.settings import Settings
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes

NAMES = ("../../../escaped.json", "..\\..\\escaped.json", "/tmp/escaped.json", "a%00/escaped.json")


def files_of(settings: Settings) -> set[str]:
    """Names of all files in the folder of uploads, and beside it."""
    return {path.name for path in Path(settings.data_folder).rglob("*") if path.is_file()}


@one_engine
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("path", ["/api/v1/sessions", "/upload"])
def test_the_name_of_a_file_is_no_path(client: httpx.Client, settings: Settings, path: str, name: str) -> None:
    part = "file" if path.startswith("/api") else "files"
    assert client.post(path, files={part: (name, session_bytes())}).status_code in (200, 201)
    (session,) = client.get("/api/v1/sessions").json()["sessions"]
    assert session["filename"] == "escaped.json"
    assert not [found for found in files_of(settings) if "escaped" in found]


def test_a_name_with_line_breaks_adds_no_header(client: httpx.Client) -> None:
    name = 'a"; filename="b\r\nX-Stolen: 1\r\n\r\n<b>.json'
    id = client.post("/api/v1/sessions", files={"file": (name, session_bytes())}).json()["id"]
    answer = client.get(f"/api/v1/sessions/{id}/file")
    assert (answer.headers["content-disposition"], "x-stolen" in answer.headers) == (
        f'attachment; filename="{id}"',
        False,
    )


@one_engine
@pytest.mark.parametrize(
    "path",
    [
        "/static/..%2f..%2fsettings.py",
        "/static/%2e%2e/%2e%2e/settings.py",
        "/static//etc/passwd",
        "/api/v1/sessions/..%2f..%2fimu-health.sqlite/file",
        "/api/v1/sessions/%2e%2e%2f%2e%2e%2fetc%2fpasswd/file",
        "/sessions/..%5c..%5cetc%5cpasswd",
        "/api/v1/units/..%2f..%2fetc%2fpasswd",
    ],
)
def test_an_address_leads_to_no_file_of_the_machine(client: httpx.Client, path: str) -> None:
    answer = client.get(path)
    assert answer.status_code in (404, 422)
    assert "root:" not in answer.text
    assert "SQLite format" not in answer.text
