"""Writers of several threads and processes that want SQLite's one place without pause: how long each waits for it."""

import argparse
import multiprocessing
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.queues import Queue

import numpy as np

from service.errors import AwayError
from service.opening import open_database
from service.storage import Database
from service.units.store import Units
from tests.databases import sqlite_databases

HELD = 0.03
"""Seconds for which a writer works in its transaction: an upload takes about that."""
THREADS, PROCESSES = 6, 3
"""Uploads at once in the service, and the service with two processes that diagnose."""

spawning = multiprocessing.get_context("spawn")


def main() -> int:
    """One line a process; exit code 1 where a writer was turned away."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seconds", type=float, default=15.0)
    seconds = asked.parse_args().seconds
    found: Queue[tuple[str, list[float], int]] = spawning.Queue()
    with sqlite_databases() as databases:
        url, end = databases.migrated(), time.time() + 5 + seconds
        kinds = [("service", THREADS), *[("diagnoses", 1)] * (PROCESSES - 1)]
        processes = [spawning.Process(target=write, args=(url, *kind, end, found)) for kind in kinds]
        for process in processes:
            process.start()
        seen = [found.get() for _ in processes]
        for process in processes:
            process.join()
    print("| process | transactions | median wait, s | 99 % | longest | turned away |")
    print("| --- | --- | --- | --- | --- | --- |")
    for name, waits, away in sorted(seen):
        middle, most = np.quantile(waits, [0.5, 0.99])
        print(f"| {name} | {len(waits)} | {middle:.2f} | {most:.2f} | {max(waits):.2f} | {away} |")
    return any(away for _, _, away in seen)


def write(url: str, name: str, threads: int, end: float, found: "Queue[tuple[str, list[float], int]]") -> None:
    """Writes in a process until the end."""
    database = open_database(url)
    with ThreadPoolExecutor(threads) as pool:
        own = [pool.submit(_write, database, end) for _ in range(threads)]
    waits, away = zip(*(one.result() for one in own), strict=True)
    found.put((name, [wait for some in waits for wait in some], sum(away)))
    database.close()


def _write(database: Database, end: float) -> tuple[list[float], int]:
    """Waits, and times that it was turned away."""
    waits, away = [], 0
    while time.time() < end:
        began = time.monotonic()
        try:
            with database.writing() as store:
                Units(store).exists("W-1")
                waits.append(time.monotonic() - began)
                time.sleep(HELD)
        except AwayError:
            waits.append(time.monotonic() - began)
            away += 1
    return waits, away


if __name__ == "__main__":
    sys.exit(main())
