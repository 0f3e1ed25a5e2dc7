"""`imu-health upload`: session files to a running service."""

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.markup import escape

from service.client import connect
from service.commands.console import DEFAULT_SERVER, AsJson, Files, Server, are_large, for_each, print_json, screen
from service.commands.sending import Sending
from service.commands.speech import said
from service.sessions.decision import Verdict
from service.sessions.words.conditions import Condition, condition_of

COLOURS = {
    Verdict.PASS: "green",
    Verdict.CONDITIONAL_PASS: "yellow",
    Verdict.UNDECIDABLE: "blue",
    Verdict.CONDITIONAL_FAIL: "dark_orange",
    Verdict.FAIL: "red",
}
"""Of the verdicts, as on the pages."""


Supersedes = Annotated[
    str | None, typer.Option(metavar="ID", help="Stored session that this corrected file stands for from now on.")
]
By = Annotated[str | None, typer.Option(help="Who replaces it; with --supersedes.")]
Wait = Annotated[
    bool, typer.Option("--wait/--no-wait", help="Wait until causes were looked for: they may be said with the verdict.")
]
Mapping = Annotated[
    Path | None, typer.Option(help="JSON file that says how tables of your own layout are read: imu-mapping/1.")
]
Why = Annotated[str | None, typer.Option(help="What was wrong; with --supersedes.")]
Check = Annotated[
    bool, typer.Option("--check", help="Only a check: judged and kept, and the next calibration is due as before.")
]


def upload_files(
    files: Files,
    server: Server = DEFAULT_SERVER,
    as_json: AsJson = False,
    *,
    supersedes: Supersedes = None,
    by: By = None,
    why: Why = None,
    wait: Wait = True,
    mapping: Mapping = None,
    check: Check = False,
) -> None:
    """Upload session files and print the verdict of each; a file that is already there is stored once."""
    if supersedes and len(files) > 1:
        raise typer.BadParameter("one corrected file stands for one session", param_hint="--supersedes")
    read_by = None if mapping is None else mapping.read_text(encoding="utf-8")
    given = {"supersedes": supersedes, "by": by, "why": why, "mapping": read_by, "check": "true" if check else None}
    stated = {name: text for name, text in given.items() if text}
    show: Callable[[dict[str, Any]], None] = print_json if as_json else _print_line
    with connect(server) as client:
        sending = Sending(client, stated, wait=wait, quiet=as_json)
        for_each(files, lambda file: _uploaded(sending, file), show, "uploading", quiet=as_json or are_large(files))


def _uploaded(sending: Sending, file: Path) -> dict[str, Any]:
    """The answer with the verdict that the session has once it is diagnosed; the job of a large file where nobody waits
    for it."""
    answer, client = sending.sent(file), sending.client
    if sending.wait and client.is_diagnosed(answer["id"]):
        session = client.get(f"/sessions/{answer['id']}").json()
        answer |= {name: session[name] for name in answer if name in session}
    return answer


def _print_line(answer: dict[str, Any]) -> None:
    """``BA-017  3f9a0c5be1d24786aa10  Fit, but the zero of A2 …  …``"""
    if "verdict" not in answer:
        screen().print(f"[bold]{escape(answer['subject'])}[/] was received: job {answer['id']} works on it")
        return
    verdict = coloured(answer["verdict"], answer["is_reference"], answer["said"])
    line = f"[bold]{escape(answer['unit'])}[/]  {answer['id']}  {verdict}  {escape(said(answer['reason']))}"
    screen().print(line, soft_wrap=True)


def coloured(word: str, is_reference: bool = False, as_said: str = "") -> str:
    """A verdict as the pages word it, with their colour; ``as_said`` where it is told with its reservations."""
    verdict = Verdict(word)
    shown: Condition = condition_of(verdict, is_reference=is_reference)
    return f"[{COLOURS[verdict]}]{escape(said(as_said or shown.word))}[/]"
