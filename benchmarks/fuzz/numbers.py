"""``python -m benchmarks.fuzz.numbers`` sends extreme numbers to a running service, and writes what became of them.

A find is an answer of 5xx, an answer that comes later than ten seconds also when it is asked for alone, an ordinary
upload after it that is not taken, a page or result of what was taken that cannot be read, and work beside the requests
that failed at it.
"""

import argparse
import json
import os
import re
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import groupby
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Protocol, TypeVar

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import httpx

from benchmarks.files.service import Service, service
from benchmarks.fuzz.extremes import EXTREMES, Case, cases, in_csv, in_xlsx
from benchmarks.fuzz.requests import Request, requests
from tests.builders import accelerometer_block

LATEST = 10.0
"""Seconds."""
BUSY = httpx.codes.SERVICE_UNAVAILABLE
MOMENT = 0.5
"""Seconds between two looks at what still waits."""
PARTS = ("", "/calibration", "/diagnosis", "/correction", "/file")
"""Parts of a session that was accepted."""
FAULT = re.compile(r"^imu_health_background_faults_total\{.*\} [1-9]")
PENDING = re.compile(r"^imu_health_pending_diagnoses (\S+)", re.MULTILINE)
PAGE = Path(__file__).with_name("NUMBERS.md")
LOG = Path("build/fuzz-numbers.log")
"""File of the service's log."""
SAMPLE = 7
"""One case of so many in the other formats: they share the checks behind the reader."""
JSON = {"Content-Type": "application/json"}
HEAD = f"""# Extreme numbers

Written by `make fuzz-numbers`. Every number of a session file of every programme, one row and whole columns alike, and
every number of the other calls of the API, has in turn each of {len(EXTREMES)} values: 0, from 5e-324 to 1.7e308 in
either sense, integers of up to 401 digits, NaN, infinities, truth values and texts. After each place an ordinary
session is uploaded, and what was taken is read again. Because other programs may have had the machine, what took
longer than ten seconds, or was asked to come again (503 with Retry-After), is sent again when nothing else is: it is a
find if it ends so then. A warning of the program is one too.

| sent | answers | of them |
| --- | --- | --- |
"""


T = TypeVar("T", bound="Named")
"""Type of the thing that is sent."""


class Named(Protocol):
    """A case or a call."""

    @property
    def name(self) -> str:
        """Name for the table."""


class Choose(Protocol):
    """Choice of the cases that are sent."""

    def __call__(self, every: Iterable[T]) -> list[T]:
        """The chosen cases."""


Ask = Callable[[int], httpx.Response]
"""Sends a case for the first (0) or second (1) time."""


@dataclass
class Tally:
    """Outcomes of the cases."""

    answers: Counter[tuple[str, int]] = field(default_factory=Counter)
    finds: list[str] = field(default_factory=list)
    late: list[tuple[str, Ask]] = field(default_factory=list)
    slowest: float = 0.0
    _lock: Lock = field(default_factory=Lock)

    def ask(self, group: str, name: str, ask: Ask) -> httpx.Response:
        """Sends a case, and notes its answer."""
        began = time.monotonic()
        try:
            answer = ask(0)
        except httpx.TransportError as fault:
            self.find(f"{name}: {fault!r}")
            answer = httpx.Response(httpx.codes.GATEWAY_TIMEOUT)
        seconds = time.monotonic() - began
        with self._lock:
            self.answers[group, answer.status_code] += 1
            self.slowest = max(self.slowest, seconds)
            is_asked_back = answer.status_code == BUSY and "Retry-After" in answer.headers
            if seconds > LATEST or is_asked_back:
                self.late.append((name, ask))
        if answer.status_code >= httpx.codes.INTERNAL_SERVER_ERROR and not is_asked_back:
            self.find(f"{name}: {answer.status_code}")
        return answer

    def enqueue_again(self) -> None:
        """Sends the late cases again, one by one."""
        for name, ask in self.late:
            began = time.monotonic()
            status = ask(1).status_code
            seconds = time.monotonic() - began
            if seconds > LATEST or status >= httpx.codes.INTERNAL_SERVER_ERROR:
                self.find(f"{name}, alone: {status} in {seconds:.1f} s")

    def find(self, text: str) -> None:
        """Prints and records a finding."""
        print(text, flush=True)
        self.finds.append(text)


def main() -> None:
    """Send everything, wait for the diagnoses so long at most, read what was taken again, and write the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.fuzz.numbers", description=__doc__)
    parser.add_argument("--only", default="", help="only cases whose name holds this")
    parser.add_argument("--every", type=int, default=1, help="one case of so many")
    parser.add_argument("--wait", type=float, default=60, help="minutes that diagnoses are waited for")
    parser.add_argument("--read", type=int, default=5, help="one stored session of so many is read again")
    parser.add_argument("--clients", type=int, default=3, help="that send at a time")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    tally = Tally()

    def chosen(every: Iterable[T]) -> list[T]:
        return [one for one in every if options.only in one.name][:: options.every]

    with TemporaryDirectory() as folder, service(Path(folder), _ordinary("FIRST")) as running:
        began = time.monotonic()
        with ThreadPoolExecutor(options.clients) as pool:
            taken = list(_sent(running, tally, chosen(cases()), pool))
            _others(running, tally, pool, chosen)
        _next(running, tally, "all other calls", -2)
        minutes = (time.monotonic() - began) / 60
        left = _waited(running, options.wait * 60)
        for id in taken[:: options.read]:
            _read(running, tally, id)
        tally.enqueue_again()
        failed = running.client.get(f"{running.address}/api/v1/jobs/failed").json()["failed"]
        for one in failed:
            tally.find(f"{one['kind']} of {one['of']}: {one['why']}")
        for line in running.client.get(f"{running.address}/metrics").text.splitlines():
            if FAULT.match(line):
                tally.find(line)
        log = (Path(folder) / "log").read_text()
    LOG.parent.mkdir(exist_ok=True)
    LOG.write_text(log)
    for line in log.splitlines():
        if any(word in line for word in ("Traceback", "Warning", '"level": "error"')):
            tally.find(f"log: {line[:300]}")
    made = f"{len(taken) - left:,} of the {len(taken):,} sessions that were taken were diagnosed when it ended."
    options.out.write_text(_page(tally, minutes, made))
    print(options.out.read_text())


def _sent(running: Service, tally: Tally, tried: Iterable[Case], pool: ThreadPoolExecutor) -> Iterator[str]:
    """Every case, and an ordinary session after each place; ids of what was taken."""
    places = [(place, tuple(own)) for place, own in groupby(tried, lambda case: (case.programme, case.way))]

    def send(number: int) -> list[str]:
        place, own = places[number]
        answers = [
            _upload(
                running, tally, case.programme, case.name, partial(_written, Case.content, case, f"EX-{number}-{at}")
            )
            for at, case in enumerate(own)
        ]
        _next(running, tally, f"after {place}", number)
        return [answer.json()["id"] for answer in answers if answer.status_code == httpx.codes.CREATED]

    for ids in pool.map(send, range(len(places))):
        yield from ids


def _upload(running: Service, tally: Tally, group: str, name: str, content: Callable[[int], bytes]) -> httpx.Response:
    url = f"{running.address}/api/v1/sessions"
    return tally.ask(group, name, lambda again: running.client.post(url, content=content(again)))


def _read(running: Service, tally: Tally, id: str) -> None:
    """Asks for everything that the service makes of a stored session."""
    unit = running.client.get(f"{running.address}/api/v1/sessions/{id}").json()["unit"]
    paths = (*(f"/api/v1/sessions/{id}{part}" for part in PARTS), f"/sessions/{id}", f"/units/{unit}")
    for path in (*paths, f"/api/v1/units/{unit}/usable"):
        tally.ask("what was taken, read again", path, partial(_got, running, path))


def _got(running: Service, path: str, _: int) -> httpx.Response:
    return running.client.get(f"{running.address}{path}")


def _next(running: Service, tally: Tally, name: str, number: int) -> None:
    answer = _upload(running, tally, "an ordinary session", name, lambda again: _ordinary(f"ORD{again}-{number}"))
    if answer.status_code != httpx.codes.CREATED:
        tally.find(f"{name}: an ordinary upload got {answer.status_code}")


def _others(running: Service, tally: Tally, pool: ThreadPoolExecutor, chosen: Choose) -> None:
    """The other formats for a sample, and every number of every other call."""
    sample = chosen([case for case in cases() if case.programme == "two-axis-stand"][::SAMPLE])

    def send(form: str, written: Callable[[Case, str], bytes], number: int) -> None:
        own = partial(_written, written, sample[number], f"{form[3:]}-{number}")
        _upload(running, tally, form, f"{form}, {sample[number].name}", own)

    for form, written in (("as CSV", in_csv), ("as XLSX", in_xlsx)):
        list(pool.map(partial(send, form, written), range(len(sample))))
    known = {
        "serial": "FIRST",
        "id": running.client.get(f"{running.address}/api/v1/units/FIRST").json()["sessions"][0]["id"],
    }
    calls = chosen(requests(running.client.get(f"{running.address}/openapi.json").json(), known))
    list(pool.map(lambda one: tally.ask("other calls of the API", one.name, partial(_called, running, one)), calls))


def _called(running: Service, one: Request, _: int) -> httpx.Response:
    return running.client.request(one.method, f"{running.address}{one.path}", content=one.body, headers=JSON)


def _written(written: Callable[[Case, str], bytes], case: Case, unit: str, again: int) -> bytes:
    return written(case, f"{unit}-{again}")


def _waited(running: Service, most: float) -> int:
    """Waits, for so many seconds at most, until every diagnosis is made; how many are not."""
    end = time.monotonic() + most
    while (left := _pending(running)) and time.monotonic() < end:
        time.sleep(MOMENT)
    return left


def _pending(running: Service) -> int:
    found = PENDING.search(running.client.get(f"{running.address}/metrics").text)
    assert found is not None
    return int(float(found[1]))


def _ordinary(unit: str) -> bytes:
    document = accelerometer_block(3, positions=4, unit=unit)
    document["stand"]["id"] = unit
    return json.dumps(document | {"unit_type": unit}).encode()


def _page(tally: Tally, minutes: float, made: str) -> str:
    groups = dict.fromkeys(group for group, _ in tally.answers)
    lines = [
        f"| {group} | {sum(n for (g, _), n in tally.answers.items() if g == group):,} | {_codes(tally, group)} |"
        for group in groups
    ]
    finds = "\n".join(f"* {find}" for find in tally.finds) or "None."
    return (
        HEAD
        + "\n".join(lines)
        + f"""

{sum(tally.answers.values()):,} answers in {minutes:.0f} minutes by the clock; the slowest took {tally.slowest:.1f} s.
{made}

## Finds

{finds}
"""
    )


def _codes(tally: Tally, group: str) -> str:
    own = sorted((code, n) for (g, code), n in tally.answers.items() if g == group)
    return ", ".join(f"{n:,} × {code}" for code, n in own)


if __name__ == "__main__":
    main()
