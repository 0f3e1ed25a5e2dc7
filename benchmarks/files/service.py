"""A service of its own, and what a file costs it: memory of all its processes, and how long others wait."""

import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Event, Thread

import httpx
import psutil

BETWEEN = 0.02
"""Seconds between two looks at the memory, and between two questions to /healthz."""
SERVE = "from service.cli import main; main()"
"""Program of the service, as the command runs it."""
NOTHING = 10.0
"""Seconds after which a service has nothing to do any more, and for which it is watched while nothing is sent."""
MEBIBYTE = 1024**2


@dataclass(frozen=True)
class Cost:
    """Cost of one file, or of several at once."""

    statuses: tuple[int, ...]
    says: str
    """The sentence of the first answer."""
    seconds: float
    memory: float
    """Peak over idle of the service and all its processes until the file is diagnosed, MiB; shared pages are counted
    once."""
    wait: float
    """Longest of /healthz, s."""


@dataclass(frozen=True)
class Service:
    """A running service."""

    address: str
    process: psutil.Process
    idle: float
    """MiB."""
    processes: int
    """Number of processes that it has started and keeps."""
    client: httpx.Client
    """One, because to make one takes longer than an answer."""

    def cost(self, contents: list[bytes]) -> Cost:
        """The cost of these files, sent at once."""
        done, peaks, waits = Event(), [self.idle], [0.0]
        watchers = [
            Thread(target=_until, args=(done, lambda: peaks.append(memory(self.process)))),
            Thread(target=_until, args=(done, lambda: waits.append(self._healthy()))),
        ]
        for watcher in watchers:
            watcher.start()
        began, answers = time.monotonic(), self._sent(contents)
        seconds = time.monotonic() - began
        self.rest()
        done.set()
        for watcher in watchers:
            watcher.join()
        if not answers:
            return Cost((), "", seconds, max(peaks) - self.idle, max(waits))
        problems = answers[0].json().get("problems") or [{"message": answers[0].json().get("detail", "")}]
        codes = tuple(sorted(answer.status_code for answer in answers))
        return Cost(codes, problems[0]["message"], seconds, max(peaks) - self.idle, max(waits))

    def rest(self) -> None:
        """Waits until nothing reads or diagnoses any more: each does so in a process of its own."""
        while len(self.process.children(recursive=True)) > self.processes:
            time.sleep(BETWEEN)

    def _sent(self, contents: list[bytes]) -> list[httpx.Response]:
        answers: list[httpx.Response] = []
        if not contents:
            time.sleep(NOTHING)

        def send(content: bytes) -> None:
            url = f"{self.address}/api/v1/sessions"
            answers.append(httpx.post(url, files={"file": ("file", content)}, timeout=300))

        senders = [Thread(target=send, args=(content,)) for content in contents]
        for sender in senders:
            sender.start()
        for sender in senders:
            sender.join()
        return answers

    def _healthy(self) -> float:
        began = time.monotonic()
        self.client.get(f"{self.address}/healthz").raise_for_status()
        return time.monotonic() - began


def _until(done: Event, look: Callable[[], None]) -> None:
    while not done.is_set():
        look()
        time.sleep(BETWEEN)


def memory(process: psutil.Process) -> float:
    """MiB of a process and all that it started, shared pages counted once (proportional set size, Linux)."""
    total = 0
    for one in (process, *process.children(recursive=True)):
        try:
            total += one.memory_full_info().pss
        except psutil.Error:
            continue
    return total / MEBIBYTE


@contextmanager
def service(folder: Path, first: bytes) -> Iterator[Service]:
    """A service that holds one session, once its readers and what diagnoses have been started."""
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-c", SERVE, "serve", "--port", str(port), "--data-folder", str(folder)]
    address = f"http://127.0.0.1:{port}"
    with (folder / "log").open("w") as log, subprocess.Popen(command, stdout=log, stderr=log) as process:
        try:
            _wait_for(address)
            httpx.post(f"{address}/api/v1/sessions", content=b"PAR1", timeout=60)
            own = psutil.Process(process.pid)
            with httpx.Client(timeout=300) as client:
                answer = client.post(f"{address}/api/v1/sessions", files={"file": ("file", first)}).raise_for_status()
                _diagnosed(client, answer.json()["url"])
                yield Service(address, own, memory(own), len(own.children(recursive=True)), client)
        finally:
            process.terminate()


def _diagnosed(client: httpx.Client, session: str) -> None:
    while client.get(f"{session}/diagnosis").raise_for_status().status_code == httpx.codes.ACCEPTED:
        time.sleep(BETWEEN)
    time.sleep(NOTHING)


def _wait_for(address: str) -> None:
    for _ in range(600):
        try:
            httpx.get(f"{address}/readyz")
        except httpx.TransportError:
            time.sleep(0.1)
        else:
            return
    raise TimeoutError("the service did not start")
