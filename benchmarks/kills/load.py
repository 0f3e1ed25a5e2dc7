"""Clients that upload sessions without pause, and remember which ones they were told are stored."""

import json
import random
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from threading import Event, Lock
from time import monotonic, sleep

import httpx

from tests.service.made_sessions import session_bytes
from tests.service.storage.intact import SENSORS

CLIENTS = 2
SESSIONS_OF_A_UNIT = 6
"""Sessions of a unit: enough that histories are read and written too, few enough that uploads stay fast."""
GIVEN_UP = 0.5
"""Share of the unanswered uploads that are never sent again: those may be stored or not, but not by halves."""
PAUSE = 0.02
"""Seconds before a service that does not answer is tried again."""

LONGEST = 120.0
"""Seconds in which what is waited for must be acknowledged, on a machine that has much else to do."""


@dataclass
class Load:
    """Uploads sent, and uploads acknowledged."""

    address: str
    seed: int
    sent: set[bytes] = field(default_factory=set)
    acknowledged: set[bytes] = field(default_factory=set)
    repeated: int = 0
    """Acknowledged uploads that had been sent before without an answer."""
    refused: list[str] = field(default_factory=list)
    """Answers that a sound upload must never get."""
    _numbers: Iterator[int] = field(default_factory=count)
    _lock: Lock = field(default_factory=Lock)
    _stop: Event = field(default_factory=Event)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Uploads until the block ends."""
        with ThreadPoolExecutor(CLIENTS) as pool:
            clients = [pool.submit(self._upload_for_ever, random.Random(f"{self.seed} {n}")) for n in range(CLIENTS)]
            try:
                yield
            finally:
                self._stop.set()
        for client in clients:
            client.result()

    def wait_for(self, uploads: int) -> None:
        """Waits until so many uploads were acknowledged."""
        end = monotonic() + LONGEST
        while len(self.acknowledged) < uploads:
            if monotonic() > end:
                raise TimeoutError(f"{len(self.acknowledged)} of {uploads} uploads in {LONGEST} s: {self.refused}")
            sleep(PAUSE)

    def _upload_for_ever(self, chance: random.Random) -> None:
        with httpx.Client(base_url=self.address, timeout=120) as client:
            while not self._stop.is_set():
                with self._lock:
                    content = _session(next(self._numbers))
                    self.sent.add(content)
                self._upload(client, content, chance)

    def _upload(self, client: httpx.Client, content: bytes, chance: random.Random) -> None:
        """Uploads until the session is acknowledged or given up, or the load ends."""
        tries = 0
        while not self._stop.wait(PAUSE if tries else 0):
            tries += 1
            try:
                answer = client.post("/api/v1/sessions", content=content)
            except httpx.ConnectError:
                continue
            except httpx.TransportError:
                if chance.random() < GIVEN_UP:
                    return
                continue
            if answer.status_code in (200, 201):
                with self._lock:
                    self.acknowledged.add(content)
                    self.repeated += tries > 1
                return
            if answer.status_code != 503:
                self.refused.append(f"{answer.status_code}: {json.dumps(answer.text)[:200]}")
                return


def _session(number: int) -> bytes:
    """The sessions of a unit, a month apart; then those of the next."""
    unit, month = divmod(number, SESSIONS_OF_A_UNIT)
    return session_bytes(seed=number, unit=f"KT-{unit:04d}", month=month + 1, m=SENSORS)
