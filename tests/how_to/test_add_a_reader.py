"""docs/how-to/add-a-reader.md, followed: a format of session files, and a converter of recordings."""

import gzip
from pathlib import Path

import httpx
import pytest

from tests.how_to.follow import House, followed
from tests.service.made_sessions import session_bytes


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> House:
    """The source with the page's reader and converter."""
    return followed("add-a-reader", tmp_path_factory.mktemp("reader"))


def test_a_packed_session_is_taken_and_damaged_ones_are_refused(house: House) -> None:
    packed = gzip.compress(session_bytes())
    with house.serving() as address, httpx.Client(base_url=f"{address}/api/v1") as client:
        plain = client.post("/sessions", content=session_bytes())
        taken = client.post("/sessions", content=packed)
        torn = client.post("/sessions", content=packed[:-200])
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
