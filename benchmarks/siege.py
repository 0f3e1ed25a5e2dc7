"""Sends costly requests from ten addresses, twenty a second, and looks at what somebody else meets meanwhile; a table,
and exit code 1 where a limit is passed.

The requests: wrong passwords, a register of 20,000 headings, a megabyte of commas, a register of 2,000 units, and the
deletion of one's own token.
"""

import argparse
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from datetime import UTC, datetime
from itertools import count, cycle
from pathlib import Path

import httpx

from benchmarks.kills.server import Service, free_port
from service.kit.person import Role
from service.settings import Settings
from tests.databases import sqlite_databases
from tests.service.made_sessions import session_bytes
from tests.service.people.staff import Staff, staffed
from tests.stock import stores

ADDRESSES = 10
RATE = 20.0
"""Requests a second, of all addresses together."""
MOST_MEMORY = 1000.0
"""MB of the service and its processes."""
LONGEST = 2.0
"""Seconds that somebody else waits."""
PATIENCE = 120.0
"""Seconds after which a request counts as unanswered."""
MOST_OPEN = 500
"""Requests that the attackers keep open at once."""
COLUMNS, UNITS = 20_000, 2_000


@dataclass
class Seen:
    """Observations of a run."""

    answers: Counter[str] = field(default_factory=Counter)
    """Attackers' answers, by kind of request and status."""
    faults: Counter[str] = field(default_factory=Counter)
    """Answers that must not be: 5xx but 503 with Retry-After."""
    waits: list[tuple[float, str]] = field(default_factory=list)
    """Seconds and address of every request of somebody else."""
    memory: float = 0.0
    """MB at most."""


def main() -> int:
    """The table."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seconds", type=float, default=300.0)
    seconds = asked.parse_args().seconds
    seen = besieged(seconds)
    worst = sorted(seen.waits, reverse=True)
    print(
        f"{sum(seen.answers.values())} requests in {seconds:.0f} s from {ADDRESSES} addresses: {dict(seen.answers)}\n"
    )
    print("| | here | limit |\n| --- | --- | --- |")
    print(f"| memory of the service and its processes, MB | {seen.memory:.0f} | {MOST_MEMORY:.0f} |")
    print(f"| longest wait of somebody else, s ({worst[0][1]}), of {len(worst)} | {worst[0][0]:.2f} | {LONGEST:.0f} |")
    print(f"| 5xx, but 503 with Retry-After | {sum(seen.faults.values())} {dict(seen.faults)} | 0 |")
    return int(seen.memory > MOST_MEMORY or worst[0][0] > LONGEST or bool(seen.faults))


def besieged(seconds: float) -> Seen:
    """Observations of a service with accounts, on SQLite, under attack for so many seconds."""
    seen = Seen()
    with sqlite_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-siege-") as folder:
        settings = Settings(database_url=databases.migrated(), data_folder=Path(folder))
        with stores(settings) as storage:
            staff = staffed(storage, datetime.now(UTC), signing=("engineer",))
        service = Service(settings, free_port())
        service.start()
        try:
            _siege(service, staff, seconds, seen)
        finally:
            service.kill()
    return seen


def _siege(service: Service, staff: Staff, seconds: float, seen: Seen) -> None:
    end = time.monotonic() + seconds
    others = [threading.Thread(target=work, args=(service, staff, end, seen)) for work in (_somebody_else, _measure)]
    for thread in others:
        thread.start()
    clients = [_from(service, f"127.0.0.{10 + n}") for n in range(ADDRESSES)]
    unit_type = _begun(clients[0], staff)
    attacks, senders = cycle(_attacks(staff, unit_type).items()), cycle(clients)
    pool, number, start = ThreadPoolExecutor(MOST_OPEN), 0, time.monotonic()
    while time.monotonic() < end:
        name, attack = next(attacks)
        pool.submit(_attack, next(senders), name, attack, seen)
        number += 1
        time.sleep(max(0.0, start + number / RATE - time.monotonic()))
    pool.shutdown(wait=False, cancel_futures=True)
    for thread in others:
        thread.join()


def _from(service: Service, address: str) -> httpx.Client:
    limits = httpx.Limits(max_connections=None, max_keepalive_connections=20)
    transport = httpx.HTTPTransport(local_address=address, limits=limits)
    return httpx.Client(transport=transport, base_url=service.address, timeout=PATIENCE)


Attack = Callable[[httpx.Client], httpx.Response]


def _begun(client: httpx.Client, staff: Staff) -> str:
    """Uploads a first session; the name of its type."""
    client.post("/api/v1/sessions", content=session_bytes(), headers=staff.headers(Role.CREW)).raise_for_status()
    name: str = client.get("/api/v1/units", headers=staff.headers(Role.CREW)).json()["units"][0]["unit_type"]
    return name


def _attacks(staff: Staff, unit_type: str) -> dict[str, Attack]:
    csv = {"Content-Type": "text/csv"}
    crew, engineer = staff.headers(Role.CREW), staff.headers(Role.ENGINEER)
    wide = (",".join(f"c{n}" for n in range(COLUMNS)) + "\n" + "x\n" * 2000).encode()
    commas = b"," * 1_000_000
    wrong = {"login": "engineer", "password": "wrong horse battery"}
    times = count()

    def register(http: httpx.Client, content: bytes) -> httpx.Response:
        return http.post("/api/v1/register", files={"file": ("a.csv", content)}, data={"by": "a"}, headers=engineer)

    def many() -> bytes:
        """Two thousand units, each time at another place."""
        place = f"Hangar {next(times)}"
        rows = (f'R-{n},"{unit_type}",{place}' for n in range(UNITS))
        return ("serial,unit_type,location\n" + "\n".join(rows)).encode()

    return {
        "password": lambda http: http.post("/sign-in", data=wrong),
        "wide register": lambda http: register(http, wide),
        "commas": lambda http: http.post("/api/v1/sessions", content=commas, headers=crew | csv),
        "units": lambda http: register(http, many()),
        "token": lambda http: http.delete("/api/v1/tokens/999999", headers=crew),
    }


def _attack(client: httpx.Client, name: str, attack: Attack, seen: Seen) -> None:
    try:
        answer = attack(client)
    except httpx.TransportError as fault:
        seen.answers[f"{name} {type(fault).__name__}"] += 1
        return
    seen.answers[f"{name} {answer.status_code}"] += 1
    if answer.status_code >= 500 and not (answer.status_code == 503 and "Retry-After" in answer.headers):
        seen.faults[f"{name} {answer.status_code}"] += 1


def _somebody_else(service: Service, staff: Staff, end: float, seen: Seen) -> None:
    """Looks at pages and uploads a session now and then, one request after another."""
    number = 0
    with _from(service, "127.0.0.2") as http:
        while time.monotonic() < end:
            number += 1
            content = (
                session_bytes(seed=number, unit=f"S-{number % 5}", month=1 + number % 9) if number % 5 == 0 else b""
            )
            for path in ("/healthz", "/api/v1/units", "/", "/api/v1/sessions"):
                if path == "/api/v1/sessions" and not content:
                    continue
                begun = time.monotonic()
                headers = staff.headers(Role.CREW)
                post = path == "/api/v1/sessions"
                answer = http.post(path, content=content, headers=headers) if post else http.get(path, headers=headers)
                seen.waits.append((time.monotonic() - begun, path))
                if answer.status_code >= 400:
                    seen.faults[f"somebody else {path} {answer.status_code}"] += 1
            time.sleep(0.5)


def _measure(service: Service, _: Staff, end: float, seen: Seen) -> None:
    """Reads the resident memory of the service and of the processes that it started."""
    assert service.process is not None
    while time.monotonic() < end:
        assert service.process.pid is not None
        seen.memory = max(seen.memory, sum(map(_resident, _family(service.process.pid))))
        time.sleep(0.5)


def _family(pid: int) -> list[int]:
    """A process and all that came from it."""
    try:
        children = Path(f"/proc/{pid}/task/{pid}/children").read_text().split()
    except OSError:
        return []
    return [pid, *(member for child in children for member in _family(int(child)))]


def _resident(pid: int) -> float:
    try:
        status = Path(f"/proc/{pid}/smaps_rollup").read_text()
    except OSError:
        return 0.0
    return sum(int(line.split()[1]) for line in status.splitlines() if line.startswith("Pss:")) / 1000


if __name__ == "__main__":
    sys.exit(main())
