"""Long work that is followed on a terminal: a bar on standard error, which can be left while the work goes on."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import sleep
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    DownloadColumn,
    MofNCompleteColumn,
    Progress,
    ProgressColumn,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from service.client import Client
from service.commands.exits import say
from service.jobs.records import KILOBYTE, OPEN, JobKind

LOOK_EVERY = 1.0
"""Seconds between two looks at a job that is followed."""


def followed(client: Client, id: int, *, quiet: bool) -> dict[str, Any]:
    """The job once it has ended. Whoever breaks off is told that it goes on, and how to find it again."""
    job: dict[str, Any] = client.get(f"/jobs/{id}").json()
    is_upload = job["kind"] == JobKind.UPLOAD
    size = KILOBYTE if is_upload else 1
    try:
        with bar(f"job {id}", quiet=quiet, counts=DownloadColumn() if is_upload else MofNCompleteColumn()) as moved:
            while job["state"] in OPEN:
                moved(size * job["done"], size * job["total"] if job["done"] else None, _doing(job))
                sleep(LOOK_EVERY)
                job = client.get(f"/jobs/{id}").json()
    except KeyboardInterrupt:
        say(f"Job {id} goes on without you: imu-health jobs show {id} --wait, or imu-health jobs cancel {id}")
        raise
    return job


def _doing(job: dict[str, Any]) -> str:
    if job["kind"] != JobKind.UPLOAD:
        return f"job {job['id']}"
    again = f", time {job['times'] + 1}" if job["times"] else ""
    return f"job {job['id']}: reading {job['subject']}{again}"


Moved = Callable[[int, int | None, str], None]
"""How much is done, of how much where that is known, and what it is."""


@contextmanager
def bar(doing: str, *, quiet: bool, counts: ProgressColumn) -> Iterator[Moved]:
    """A bar, on a terminal only; yields what moves it on."""
    is_shown = not quiet and sys.stderr.isatty() and sys.stdout.isatty()
    columns = (TextColumn("{task.description}"), BarColumn(), counts, TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=Console(stderr=True), transient=True, disable=not is_shown) as progress:
        task = progress.add_task(doing, total=None)

        def moved(done: int, total: int | None, now: str) -> None:
            progress.update(task, completed=done, total=total, description=now)

        yield moved
