"""Uploads sessions one after another and looks at the service's memory and descriptors on the way; a table, and exit
code 1 where descriptors grow. As a row of the benchmarks: the last look against the first."""

import argparse
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import httpx

from benchmarks.figures import Figure
from benchmarks.kills.server import Service, free_port
from service.settings import Settings
from tests.databases import sqlite_databases
from tests.service.made_sessions import session_bytes

LOOKS = 6
"""Times that it is looked, evenly over the uploads."""
SPARE = 20
"""Descriptors that may come and go: connections of the pool, files that are read at the moment."""

ORDINARY = 300
"""Uploads of a run."""

NOTE = """
The soak is short here; [a longer one](../docs/security/durability.md#long-runs) shows the same.
"""

Look = tuple[int, float, int]
"""Uploads so far, resident memory in MB, open descriptors."""


def main() -> int:
    """The table."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--uploads", type=int, default=ORDINARY)
    given = asked.parse_args()
    seen = soaked_anew(given.uploads)
    print("| uploads | memory, MB | descriptors |\n| --- | --- | --- |")
    print("\n".join(f"| {number} | {memory:.0f} | {handles} |" for number, memory, handles in seen))
    return seen[-1][2] > seen[0][2] + SPARE


def run() -> Iterator[Figure]:
    """Memory and descriptors after all uploads, against those after the first sixth."""
    seen = soaked_anew(ORDINARY)
    (first, memory, handles), (last, memory_last, handles_last) = seen[0], seen[-1]
    work, peer = f"after {last} uploads", f"after {first}"
    yield Figure("soak, memory", f"memory of the service {work}", peer, memory_last, memory, "≥ 0.95", "MB")
    yield Figure("soak, descriptors", f"open descriptors {work}", peer, handles_last, handles, "≥ 0.5", "")


def soaked_anew(uploads: int) -> list[Look]:
    """Memory and descriptors on the way, of a service with an empty database."""
    with sqlite_databases() as databases, tempfile.TemporaryDirectory(prefix="imu-soak-") as folder:
        return soaked(Settings(database_url=databases.migrated(), data_folder=Path(folder)), uploads)


def soaked(settings: Settings, uploads: int) -> list[Look]:
    """Memory and descriptors on the way, of a service of its own."""
    service = Service(settings, free_port())
    service.start()
    try:
        return _looked(service, uploads)
    finally:
        service.kill()


def _looked(service: Service, uploads: int) -> list[Look]:
    assert service.process is not None
    assert service.process.pid is not None
    seen, every = [], max(uploads // LOOKS, 1)
    with httpx.Client(base_url=service.address, timeout=120) as client:
        for number in range(1, uploads + 1):
            content = session_bytes(seed=number, unit=f"SK-{number:05d}", m=4)
            client.post("/api/v1/sessions", content=content).raise_for_status()
            if number % every == 0:
                seen.append((number, *_taken(service.process.pid)))
    return seen


def _taken(pid: int) -> tuple[float, int]:
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6, len(list(Path(f"/proc/{pid}/fd").iterdir()))


if __name__ == "__main__":
    sys.exit(main())
