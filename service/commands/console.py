"""Shared parts of commands: options, handling of unusable files, and output.

A list is a table on a terminal and one JSON object a line in a pipe, unless one of them is asked for.
"""

import json
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated, Any, TypeVar

import typer
from rich.console import Console, RenderableType
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.table import Table

from estimator.errors import SessionError
from service.commands.speech import UNUSABLE, output_language, problems_in_words, say, translated
from service.errors import RefusedError, TooLargeError
from service.languages.language import Language

T = TypeVar("T")


AsLines = Annotated[
    bool | None,
    typer.Option(
        "--json/--table",
        help="JSON, one object a line, or a table.",
        show_default="a table on a terminal, JSON in a pipe",
    ),
]
Files = Annotated[list[Path], typer.Argument(metavar="FILE", help="Session files.", show_default=False)]
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON: one object; with several files one a line.")]
Server = Annotated[str, typer.Option(help="Address of the service.", envvar="IMU_HEALTH_SERVER")]
Out = Annotated[Path | None, typer.Option(help="File to write.", show_default="standard output")]
WIDE = 160
"""Columns of a table in a file or a pipe."""
LARGE = 8 * 1024 * 1024
"""Bytes of a file that takes seconds: a log of an hour at 100 Hz."""
DEFAULT_SERVER = "http://127.0.0.1:8000"
"""Default address of `imu-health serve`."""


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


def say_unusable(file: Path, fault: SessionError | RefusedError | TooLargeError | OSError) -> None:
    """All problems of a file on one line: the file, then each field, row and what to do."""
    if isinstance(fault, OSError):
        why = fault.strerror or fault
        say(f"{file}: " + translated("file: {why}; check the name and that it can be read", why=why))
    elif isinstance(fault, TooLargeError):
        say(f"{file}: {translated('file: {why}', why=fault.detail)}")
    else:
        say(f"{file}: {problems_in_words(fault.problems)}")


@contextmanager
def usable(file: Path) -> Iterator[None]:
    """Exit code 2 with one line for an unusable file."""
    try:
        yield
    except (SessionError, RefusedError, OSError) as fault:
        say_unusable(file, fault)
        raise typer.Exit(UNUSABLE) from fault


def for_each(
    files: list[Path],
    work: Callable[[Path], T],
    show: Callable[[T], None],
    doing: str,
    *,
    quiet: bool = False,
    has_bar: bool = True,
    summary: Callable[[], str] = str,
) -> None:
    """Processes every file in order and shows each result; unusable ones get a line, and exit code 2 at the end.
    Unless ``quiet``, several files end with a line of summary: those that failed, then ``summary``."""
    unusable: list[Path] = []
    with progress(len(files), doing, quiet=quiet or not has_bar, is_long=are_large(files)) as advance:
        for file in files:
            try:
                show(work(file))
            except (SessionError, RefusedError, TooLargeError, OSError) as fault:
                say_unusable(file, fault)
                unusable.append(file)
            advance()
    if len(files) > 1 and not quiet:
        failed = translated("{failed} of {files} files failed", failed=len(unusable), files=len(files))
        names = f": {', '.join(map(str, unusable))}" if unusable else ""
        say("; ".join(filter(None, (f"{failed}{names}", summary()))) + ".")
    if unusable:
        raise typer.Exit(UNUSABLE)


def are_large(files: Iterable[Path]) -> bool:
    """Whether one of them is a log that takes more than a moment; a missing file is reported where it is read."""
    return any(file.is_file() and file.stat().st_size > LARGE for file in files)


@contextmanager
def progress(total: int, doing: str, *, quiet: bool = False, is_long: bool = False) -> Iterator[Callable[[], None]]:
    """A progress bar on standard error, for several items or a long one; yields the function that advances it.

    Only on a terminal, and neither in a pipe nor with JSON. For one item the bar shows the elapsed time.
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


@dataclass(frozen=True)
class ListOutput:
    """Form of a list: JSON, one object a line, or a table."""

    as_lines: bool

    @classmethod
    def of(cls, chosen: bool | None) -> "ListOutput":
        """The chosen form, else that for a terminal or a pipe."""
        return cls(not sys.stdout.isatty() if chosen is None else chosen)

    @property
    def language(self) -> str:
        """Language of the list: JSON never depends on it."""
        return Language.ENGLISH.value if self.as_lines else output_language()

    def show(self, rows: Sequence[Any], view: Callable[[], RenderableType]) -> None:
        """Prints the rows as they were answered, or their view."""
        if not self.as_lines:
            screen().print(view())
            return
        for row in rows:
            print_json(row)


def rows_of(records: Sequence[Any]) -> list[dict[str, Any]]:
    """Records as JSON, times in ISO 8601."""
    return [{name: _plain(value) for name, value in asdict(record).items()} for record in records]


def _plain(value: Any) -> Any:
    return value.isoformat() if isinstance(value, datetime) else value


def table_of(*headings: str, right: Sequence[str] = ()) -> Table:
    """An empty table without lines; numbers are aligned to the right."""
    table = Table(box=None, pad_edge=False, header_style="bold", padding=(0, 2, 0, 0))
    for heading in headings:
        table.add_column(translated(heading), justify="right" if heading in right else "left", overflow="fold")
    return table
