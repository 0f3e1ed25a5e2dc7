"""`imu-health upload`: session files to a running service; a large one is streamed, and followed until it is stored.
A progress bar on standard error follows it, and can be interrupted while the work goes on."""

import sys
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import sleep
from typing import IO, Annotated, Any

import typer
from rich.console import Console
from rich.markup import escape
from rich.progress import BarColumn, DownloadColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

from estimator.errors import Problem
from estimator.json_object import Json
from service.client import Client, connect
from service.commands.console import DEFAULT_SERVER, AsJson, Files, Server, are_large, for_each, print_json, screen
from service.commands.speech import output_language, say, translated
from service.errors import RefusedError
from service.jobs.records import KILOBYTE, OPEN, JobState
from service.sessions.decision import Verdict
from service.sessions.words.conditions import Condition, condition_of

POLL_SECONDS = 1.0
"""Seconds between two polls of a job."""
ProgressCallback = Callable[[int, int | None, str], None]
"""Called with the amount done, the total where known, and a description."""


@dataclass(frozen=True)
class Uploader:
    """Uploads files."""

    client: Client
    stated: dict[str, str]
    """Form fields of each file."""
    wait: bool
    quiet: bool

    def sent(self, file: Path) -> Json:
        """The receipt; for a large file without waiting its job. RefusedError for an unusable file."""
        if not are_large((file,)):
            return self.client.send(file.name, file.read_bytes(), self.stated)
        size = file.stat().st_size
        with file.open("rb") as content, _bar(file.name, quiet=self.quiet) as callback:
            file_with_progress: Any = _WatchedFile(content, size, f"sending {file.name}", callback)
            answer = self.client.send(file.name, file_with_progress, self.stated, later=True)
        if "verdict" in answer or not self.wait:
            return answer
        return self._became(_followed(self.client, answer["id"], quiet=self.quiet))

    def _became(self, job: Json) -> Json:
        """The receipt of the session of a file."""
        if job["problems"]:
            problems = tuple(Problem(item["field"], item["message"], item["row"]) for item in job["problems"])
            raise RefusedError(f"{job['subject']} cannot be used.", problems)
        if job["state"] != JobState.DONE:
            reasons = " ".join(item["reason"] for item in job["failures"])
            fault = f"job {job['id']} is {job['state']}. {reasons}".strip()
            raise RefusedError(f"{job['subject']} was not stored.", (Problem("file", fault),))
        receipt: Json = self.client.get(f"/uploads/{job['upload']}").json()["session"]
        return receipt | {"created": True, "url": f"{self.client.server}/api/v1/sessions/{receipt['id']}"}


@dataclass(frozen=True)
class _WatchedFile:
    """A file that reports how much of it was read."""

    file: IO[bytes]
    size: int
    doing: str
    moved: ProgressCallback

    def read(self, size: int = -1) -> bytes:
        """The next part."""
        part = self.file.read(size)
        self.moved(self.file.tell(), self.size, self.doing)
        return part

    def fileno(self) -> int:
        """Needed to determine its length."""
        return self.file.fileno()

    def seek(self, place: int) -> int:
        """Returns to the beginning before it is sent."""
        return self.file.seek(place)


def _followed(client: Client, id: int, *, quiet: bool) -> Json:
    """The upload's job once it has ended. On an interrupt, a message says that it goes on, and where to look."""
    job: Json = client.get(f"/jobs/{id}").json()
    try:
        with _bar(f"job {id}", quiet=quiet) as callback:
            while job["state"] in OPEN:
                callback(KILOBYTE * job["done"], KILOBYTE * job["total"] if job["done"] else None, _doing(job))
                sleep(POLL_SECONDS)
                job = client.get(f"/jobs/{id}").json()
    except KeyboardInterrupt:
        say(f"Job {id} goes on without you: {client.server}/jobs/{id}")
        raise
    return job


def _doing(job: Json) -> str:
    again = f", time {job['times'] + 1}" if job["times"] else ""
    return f"job {job['id']}: reading {job['subject']}{again}"


@contextmanager
def _bar(doing: str, *, quiet: bool) -> Iterator[ProgressCallback]:
    """A progress bar of bytes, on a terminal only; yields the function that moves it."""
    is_shown = not quiet and sys.stderr.isatty() and sys.stdout.isatty()
    columns = (BarColumn(), DownloadColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(
        TextColumn("{task.description}"), *columns, console=Console(stderr=True), transient=True, disable=not is_shown
    ) as progress:
        task = progress.add_task(doing, total=None)

        def move(done: int, total: int | None, now: str) -> None:
            progress.update(task, completed=done, total=total, description=now)

        yield move


COLOURS = {
    Verdict.PASS: "green",
    Verdict.CONDITIONAL_PASS: "yellow",
    Verdict.UNDECIDABLE: "blue",
    Verdict.CONDITIONAL_FAIL: "dark_orange",
    Verdict.FAIL: "red",
}
"""Colours of the verdicts, as on the pages."""


Wait = Annotated[
    bool,
    typer.Option(
        "--wait/--no-wait", help="Wait until causes were looked for: they may add reservations to the verdict."
    ),
]
Mapping = Annotated[
    Path | None, typer.Option(help="JSON file that says how tables of your own layout are read: imu-mapping/1.")
]
Check = Annotated[bool, typer.Option("--check", help="Check only: judged and stored, does not change the due date.")]


def upload_files(
    files: Files,
    server: Server = DEFAULT_SERVER,
    as_json: AsJson = False,
    *,
    wait: Wait = True,
    mapping: Mapping = None,
    check: Check = False,
) -> None:
    """Upload session files and print the verdict of each; a file that is already there is stored once. Exit code 2
    where one of them was not stored."""
    stated = {} if mapping is None else {"mapping": mapping.read_text(encoding="utf-8")}
    stated |= {"check": "true"} if check else {}
    show: Callable[[Json], None] = print_json if as_json else _print_line
    outcomes: Counter[str] = Counter()
    with connect(server, language=output_language()) as client:
        sending = Uploader(client, stated, wait=wait, quiet=as_json)

        def work(file: Path) -> Json:
            answer = _verdict_of(sending, file)
            outcomes[_outcome(answer)] += 1
            return answer

        has_bar, counts = not are_large(files), lambda: _counts(outcomes)
        for_each(files, work, show, "uploading", quiet=as_json, has_bar=has_bar, summary=counts)


UNFINISHED, STORED, BEFORE = "unfinished", "stored", "before"
"""Outcomes of a file that did not fail."""


def _outcome(answer: Json) -> str:
    if "verdict" not in answer:
        return UNFINISHED
    return STORED if answer["created"] else BEFORE


def _counts(outcomes: Counter[str]) -> str:
    """``1 not read yet, 3 stored``."""
    said = {
        UNFINISHED: translated("{count} not read yet", count=outcomes[UNFINISHED]),
        STORED: translated("{count} stored", count=outcomes[STORED]),
        BEFORE: translated("{count} stored before", count=outcomes[BEFORE]),
    }
    return ", ".join(text for outcome, text in said.items() if outcomes[outcome])


def _verdict_of(uploader: Uploader, file: Path) -> Json:
    """The answer, with the verdict after the diagnosis; the job of a large file without waiting."""
    answer, client = uploader.sent(file), uploader.client
    if uploader.wait and client.is_diagnosed(answer["id"]):
        session = client.get(f"/sessions/{answer['id']}").json()
        answer |= {name: session[name] for name in answer if name in session}
    return answer


def _print_line(answer: Json) -> None:
    """``BA-017  3f9a0c5be1d24786aa10  Fit, but the zero of A2 …  …``"""
    if "verdict" not in answer:
        screen().print(f"[bold]{escape(answer['subject'])}[/] was received: job {answer['id']} works on it")
        return
    verdict = coloured(answer["verdict"], answer["is_reference"], answer["said"])
    stored = translated("already stored as session {id}, nothing was stored", id=answer["id"])
    reason = translated(answer["reason"]) if answer["created"] else stored
    said = " ".join(filter(None, (reason, translated(answer.get("remark", "")))))
    line = f"[bold]{escape(answer['unit'])}[/]  {answer['id']}  {verdict}  {escape(said)}"
    screen().print(line, soft_wrap=True)


def coloured(word: str, is_reference: bool = False, sentence: str = "") -> str:
    """A verdict in the words and colours of the pages; ``sentence``: with its reservations."""
    verdict = Verdict(word)
    shown: Condition = condition_of(verdict, is_reference=is_reference)
    return f"[{COLOURS[verdict]}]{escape(translated(sentence or shown.word))}[/]"
