"""A process of its own for every binary or long file: what it may do, and what becomes of the service without it."""

import os
import signal
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from io import BytesIO

import numpy as np
import polars as pl
import psutil
import pytest

from estimator.errors import FormatError
from estimator.reading import read_session
from service.errors import BusyError
from service.ingest import LONG, apart, read_upload
from service.ingest.exchange import DAMAGED, pack, unpack
from service.kit import limits
from tests import builders
from tests.estimator.test_reading_csv import csv_of, same
from tests.patience import LONG as VERY_LONG
from tests.service.ingest.test_formats import json_bytes, metadata, parquet_bytes

SMALL = builders.accelerometer_block(3, positions=2)
ENDLESS = apart.ROOT + "/tests/service/ingest/endless.h5"


@pytest.fixture
def limited():
    """Other limits, until the test ends."""
    usual = limits.in_force()
    yield lambda **changes: limits.use(replace(usual, **changes))
    limits.use(usual)


def long_log():
    """A raw log of two megabytes as text."""
    return builders.raw_log(6, orientations=24, still=600, moving=10)


def server() -> psutil.Process:
    """The process that forks."""
    read_upload(parquet_bytes(SMALL), "x")
    (found,) = [child for child in psutil.Process().children() if apart.SERVER in child.cmdline()]
    return found


@pytest.mark.parametrize("write", [json_bytes, csv_of])
def test_long_text_read_apart_is_the_same_session(write):
    content = write(long_log())
    assert len(content) > LONG
    assert same(read_upload(content, "x"), read_session(content))


def test_a_process_that_is_ended_from_outside_is_started_again():
    server().kill()
    assert read_upload(parquet_bytes(SMALL), "x").unit == SMALL["unit"]


def test_a_fork_that_is_ended_is_a_refusal_and_harms_no_other(limited):
    limited(seconds=20)
    own, refused = server(), threading.Event()

    def end_the_forks():
        while not refused.is_set():
            for fork in own.children():  # one that has ended may still be listed
                with suppress(psutil.NoSuchProcess):
                    fork.send_signal(signal.SIGSEGV)

    killer = threading.Thread(target=end_the_forks)
    killer.start()
    with open(ENDLESS, "rb") as file, pytest.raises(FormatError, match="cannot be read with"):
        read_upload(file.read(), "x")
    refused.set()
    killer.join()
    assert read_upload(parquet_bytes(SMALL), "x").unit == SMALL["unit"]


def test_no_file_gets_more_memory_than_the_limit(limited):
    limited(memory=20 * 1024**2)
    buffer = BytesIO()
    pl.select(pl.repeat(1.0, 2_000_000).alias("A1")).write_parquet(buffer, metadata={"imu-session": metadata(SMALL)})
    with pytest.raises(FormatError, match="20 MiB of memory"):
        read_upload(buffer.getvalue(), "x")


def test_no_file_gets_more_time_than_the_limit(limited):
    limited(seconds=1)
    with open(ENDLESS, "rb") as file, pytest.raises(FormatError, match="in 1 s: it is damaged"):
        read_upload(file.read(), "x")


def test_the_process_knows_nothing_of_the_environment(monkeypatch):
    monkeypatch.setenv("IMU_HEALTH_DATABASE_URL", "postgresql://user:secret@host/name")
    server().kill()
    assert "secret" not in str(server().environ())


def test_beyond_the_turns_and_those_who_wait_a_sender_is_asked_to_come_again(limited, monkeypatch):
    limited(at_once=1)
    monkeypatch.setattr(apart, "MOST_WAITING", 0)
    content = parquet_bytes(SMALL)
    with apart.turn(), ThreadPoolExecutor() as threads:
        found = [threads.submit(read_upload, content, "x") for _ in range(2)]
    assert [type(one.exception()).__name__ for one in found] == ["BusyError"] * 2
    assert read_upload(content, "x").unit == SMALL["unit"]


def test_a_file_that_waits_gets_its_turn(limited, monkeypatch):
    limited(at_once=1)
    monkeypatch.setattr(apart, "PATIENCE", VERY_LONG)
    with ThreadPoolExecutor() as threads:
        units = [session.unit for session in threads.map(read_upload, [parquet_bytes(SMALL)] * 5, "xxxxx")]
    assert units == [SMALL["unit"]] * 5


def test_patience_has_an_end(limited, monkeypatch):
    limited(at_once=0)
    monkeypatch.setattr(apart, "PATIENCE", 0.01)
    with pytest.raises(BusyError, match="Send it again"):
        read_upload(parquet_bytes(SMALL), "x")


def test_another_process_gets_a_server_of_its_own():
    own, content = server().pid, parquet_bytes(SMALL)
    pid = os.fork()
    if pid == 0:
        try:
            read_upload(content, "x")
            os.kill(os.getpid(), signal.SIGUSR1)
        finally:
            os._exit(1)
    assert os.WTERMSIG(os.waitpid(pid, 0)[1]) == signal.SIGUSR1
    assert server().pid == own


@pytest.mark.parametrize(
    "line",
    [
        b"{}", b"[]", b"{", b'{"answer": {"class": "Popen", "fields": {}}, "arrays": []}',
        b'{"answer": {"array": 3}, "arrays": []}', b'{"answer": 1, "arrays": [["O", [1]]]}',
        b'{"answer": 1, "arrays": [["f8", [-1]]]}', b'{"answer": 1, "arrays": [["f8", [1000000000000]]]}',
        b'{"answer": {"class": "Site", "fields": {"other": 1}}, "arrays": []}',
    ],
)  # fmt: skip
def test_an_answer_that_is_not_as_agreed_is_not_taken(line):
    with pytest.raises(DAMAGED):
        unpack(line, 1000, lambda array: None)


def test_a_session_comes_back_whole():
    session = read_session(builders.accelerometer_block())
    packed = pack(session)
    arrays = iter(packed.arrays)
    assert same(unpack(packed.line, 10**6, lambda array: np.copyto(array, next(arrays))), session)
