"""docs/how-to/add-a-reader.md, followed: a format of session files, and a converter of recordings."""

import gzip
from pathlib import Path

import pytest

from tests.how_to.conftest import Served
from tests.how_to.follow import House, followed
from tests.service.made_sessions import session_bytes


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> House:
    """The source with the page's reader and converter."""
    return followed(tmp_path_factory.mktemp("reader"), "add-a-reader")


def test_a_packed_session_is_taken_and_damaged_ones_are_refused(served: Served) -> None:
    content = session_bytes(unit="PACKED")
    packed = gzip.compress(content)
    plain, taken, torn = (
        served.http.post("/api/v1/sessions", content=sent) for sent in (content, packed, packed[:-200])
    )
    assert (plain.status_code, taken.status_code) == (201, 200), "the same readings are the same session"
    assert taken.json()["id"] == plain.json()["id"]
    assert (torn.status_code, torn.json()["problems"][0]["message"]) == (422, "is damaged; pack it again")


def test_a_file_that_unpacks_to_too_much_is_refused(house: House, tmp_path: Path) -> None:
    bomb = tmp_path / "bomb.json.gz"
    bomb.write_bytes(gzip.compress(bytes(129 * 1024**2), 1))
    said = house.run("python", "-c", READ.format(file=bomb))
    assert "unpacks to more than 128 MiB" in said


READ = """
from pathlib import Path
from estimator.errors import SessionError
from service.ingest import read_file
try:
    read_file(Path("{file}"))
except SessionError as fault:
    print(fault)
"""


def test_a_recording_is_converted_and_calibrated(house: House) -> None:
    shown = house.shell()
    assert "sessions/box.json" in shown
    assert "Ax" in shown
