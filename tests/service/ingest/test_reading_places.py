"""A small file that was made to be read for ever is refused, and no sender keeps another's upload out."""

import json
import struct
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from queue import Queue
from threading import Event

import httpx
import pytest

from service.errors import BusyError
from service.ingest import apart
from service.ingest.apart import SENDER
from service.ingest.formats import ULOG
from service.kit import limits
from tests.databases import all_on_one_engine
from tests.service.ingest.test_formats import parquet_bytes
from tests.service.made_sessions import session_bytes

ENDLESS = ULOG + bytes(9) + struct.pack("<HB", 60_000, 0) + bytes(297)
"""A message of an unknown type that claims more bytes than the file has."""
PARQUET = parquet_bytes(json.loads(session_bytes()))
pytest_generate_tests = all_on_one_engine


def upload(client: httpx.Client, content: bytes) -> httpx.Response:
    """Uploads a binary file."""
    return client.post("/api/v1/sessions", files={"file": ("file", content)})


@contextmanager
def places_held_by(sender: str, times: int) -> Iterator[list[bool]]:
    """Whether a sender got each of some places for reading, which it then keeps."""
    answers: Queue[bool] = Queue()
    end = Event()

    def hold() -> None:
        SENDER.set(sender)
        try:
            with apart.turn():
                answers.put(True)
                end.wait()
        except BusyError:
            answers.put(False)

    with ThreadPoolExecutor(times) as threads:
        for _ in range(times):
            threads.submit(hold)
        try:
            yield [answers.get() for _ in range(times)]
        finally:
            end.set()


def test_a_log_whose_message_is_longer_than_the_file_is_refused(client: httpx.Client) -> None:
    answer = upload(client, ENDLESS)
    assert answer.status_code == 422
    assert "is damaged: some" in answer.json()["problems"][0]["message"]


def test_many_of_them_at_once_keep_nobody_out(client: httpx.Client) -> None:
    with ThreadPoolExecutor(4) as threads:
        codes = [answer.status_code for answer in threads.map(lambda _: upload(client, ENDLESS), range(4))]
    assert set(codes) <= {422, 503}
    assert upload(client, PARQUET).status_code == 201


def test_one_sender_cannot_hold_every_place(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(apart, "PATIENCE", 0.0)
    with places_held_by("another", limits.in_force().at_once) as got:
        assert sorted(got) == [False, True]
        assert upload(client, PARQUET).status_code == 201


def test_one_address_cannot_hold_every_place(client: httpx.Client, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nobody signs in here: the client's own address already holds its share."""
    monkeypatch.setattr(apart, "PATIENCE", 0.0)
    with places_held_by(client.base_url.host, 1):
        assert upload(client, PARQUET).status_code == 503


@pytest.mark.parametrize(("size", "seconds"), [(316, 5), (5_000_000, 15), (60_000_000, 20)])
def test_a_small_file_may_take_seconds_only(size: int, seconds: int) -> None:
    assert apart.limits_of_file(bytes(size)).seconds == seconds


def test_a_long_file_may_take_longer(tmp_path: Path) -> None:
    with (tmp_path / "long").open("wb") as file:
        file.truncate(200_000_000)
    assert apart.limits_of_file(tmp_path / "long").seconds == 60
