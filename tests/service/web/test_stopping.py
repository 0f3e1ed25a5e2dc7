"""SIGTERM: the upload at hand is stored and answered, the next one is asked to come back, and the end comes in time."""

import json
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest

from tests.patience import LONG
from tests.service.commands.conftest import COMMAND, READY, ROOT
from tests.service.made_sessions import session_bytes
from tests.service.web.raw import answer, connected, head

Process = subprocess.Popen[str]
AGES = 5 * LONG
"""Seconds that nobody waits here."""


@contextmanager
def service(folder: Path, seconds: float, diagnosing: int = 0) -> Iterator[tuple[Process, str]]:
    """A service as a process of its own, and its address."""
    environment = {
        "PATH": "/usr/bin:/bin",
        "PYTHONPATH": str(ROOT),
        "IMU_HEALTH_STOP_SECONDS": str(seconds),
        "IMU_HEALTH_DIAGNOSIS_WORKERS": str(diagnosing),
    }
    command = [COMMAND, "serve", "--port", "0", "--data-folder", folder]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as process:
        try:
            assert process.stdout is not None
            yield process, process.stdout.readline().strip().removeprefix(READY)
        finally:
            process.kill()


def upload_head(content: bytes) -> bytes:
    """Head of an upload whose body is still to come."""
    return head("POST", "/api/v1/sessions", Content_Length=str(len(content)))


def refused(address: str) -> httpx.Response:
    """The first answer of a service that has been told to stop."""
    while (found := httpx.get(f"{address}/api/v1/units")).status_code == 200:
        continue
    return found


def test_the_upload_at_hand_is_stored_the_next_one_is_refused_and_the_end_comes_at_once(tmp_path: Path) -> None:
    content = session_bytes()
    with service(tmp_path, seconds=AGES, diagnosing=1) as (process, address), connected(address) as connection:
        connection.sendall(upload_head(content) + content[:1000])
        assert httpx.get(f"{address}/readyz").status_code == 200
        process.send_signal(signal.SIGTERM)
        last = refused(address)
        connection.sendall(content[1000:])
        found = answer(connection)
        assert process.wait(timeout=LONG) in (0, -signal.SIGTERM)
    assert (last.status_code, last.headers["retry-after"]) == (503, "5")
    assert (found.status, json.loads(found.body)["unit"]) == (201, "BA-017")


@pytest.mark.slow
def test_the_end_comes_in_time_whatever_is_at_hand(tmp_path: Path) -> None:
    content = session_bytes()
    with service(tmp_path, seconds=0.2) as (process, address), connected(address) as connection:
        connection.sendall(upload_head(content) + content[:1000])
        assert httpx.get(f"{address}/healthz").status_code == 200
        process.send_signal(signal.SIGTERM)
        process.wait(timeout=LONG)
