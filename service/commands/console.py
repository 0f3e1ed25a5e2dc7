"""What commands share: options, where they write, and one bad file not stopping the others."""

import json
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from estimator.errors import Problem, SessionError
from service.commands.exits import UNUSABLE, say
from service.commands.speech import problems_said
from service.errors import RefusedError

T = TypeVar("T")

Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="Session files.", show_default=False)]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON: one object; with several files one a line.")]
Server = Annotated[str, typer.Option(help="Address of the service.", envvar="IMU_HEALTH_SERVER")]
Out = Annotated[Path | None, typer.Option(help="File to write.", show_default="standard output")]
WIDE = 160
"""Columns of a table that goes to a file or another program."""
LARGE = 8 * 1024 * 1024
"""Bytes of a file that takes seconds: a log of an hour at 100 Hz."""
DEFAULT_SERVER = "http://127.0.0.1:8000"
"""Where `imu-health serve` listens unless it is told otherwise."""


def screen() -> Console:
    """Standard output for people; wide enough for a table when it is not a terminal."""
    return Console(width=None if sys.stdout.isatty() else WIDE)


def print_json(document: Any) -> None:
    """One JSON document on one line of standard output."""
    typer.echo(json.dumps(document, ensure_ascii=False, allow_nan=False))


def deliver(content: bytes, out: Path | None) -> None:
    """A document to a file, or to standard output."""
    if out is None:
        typer.echo(content, nl=False)
    else:
        out.write_bytes(content)


def problem_line(file: Path, problems: Iterable[Problem]) -> str:
    """Everything wrong with a file on one line: the file, then each field, row and what to do."""
    return f"{file}: {problems_said(problems)}"


def for_each(
    files: list[Path], work: Callable[[Path], T], show: Callable[[T], None], doing: str, *, quiet: bool = False
) -> None:
    """Works on every file in order and shows each result; unusable ones get a line, and exit code 2 at the end."""
    unusable = 0
    with progress(len(files), doing, quiet=quiet, is_long=are_large(files)) as advance:
        for file in files:
            try:
                show(work(file))
            except (SessionError, RefusedError) as fault:
                say(problem_line(file, fault.problems))
                unusable += 1
            except OSError as fault:
                say(f"{file}: file: {fault.strerror or fault}; check the name and that it can be read")
                unusable += 1
            advance()
    if unusable:
        raise typer.Exit(UNUSABLE)


def are_large(files: Iterable[Path]) -> bool:
    """Whether one of them is a log that takes more than a moment; one that is not there says so where it is read."""
    return any(file.is_file() and file.stat().st_size > LARGE for file in files)


@contextmanager
def progress(total: int, doing: str, *, quiet: bool = False, is_long: bool = False) -> Iterator[Callable[[], None]]:
    """A bar on standard error, for more than one thing or one that takes long; yields what moves it on.

    Only on a terminal, and neither in a pipe nor beside JSON. Of one thing nobody knows how far it is: the bar says
    that it goes on, and since when.
    """
    several = total > 1
    counts = (MofNCompleteColumn(), TimeRemainingColumn()) if several else (TimeElapsedColumn(),)
    bar = Progress(
        TextColumn("{task.description}"),
        BarColumn(),
        *counts,
        console=Console(stderr=True),
        transient=True,
        disable=quiet or not (several or is_long) or not (sys.stderr.isatty() and sys.stdout.isatty()),
    )
    with bar:
        task = bar.add_task(doing, total=total if several else None)
        yield lambda: bar.advance(task)
