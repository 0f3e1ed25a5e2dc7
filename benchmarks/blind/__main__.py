"""``python -m benchmarks.blind write FOLDER``, ``answer FOLDER``, ``score FOLDER ANSWERS``, ``table FOLDER ANSWERS…``:
docs/diagnosis/blind.md."""

import argparse
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.blind.answer import Look, Threshold, causes_given, looks
from benchmarks.blind.entrants import ENTRANTS, OURS
from benchmarks.blind.folder import Answers, drawn, numbers, read_answers, read_secret, write
from benchmarks.blind.marks import compared, marked_table, outcomes

T = TypeVar("T")


def secret_of(folder: Path) -> Path:
    """The file that is not given away: beside the folder."""
    return folder.with_name(f"{folder.name}.secret.json")


def parser() -> argparse.ArgumentParser:
    """Four commands."""
    found = argparse.ArgumentParser(prog="python -m benchmarks.blind", description=__doc__)
    commands = found.add_subparsers(dest="command", required=True)
    for name in ("write", "answer", "score", "table"):
        commands.add_parser(name).add_argument("folder", type=Path)
    written, answered, scored, table = (commands.choices[name] for name in ("write", "answer", "score", "table"))
    written.add_argument("--sessions", type=int, default=1000)
    written.add_argument("--seed", type=int, help="makes an open benchmark, which anybody can mark")
    written.add_argument("--sound", action="store_true", help="no session has an effect: sets thresholds")
    answered.add_argument("--by", nargs="+", default=[OURS], choices=[OURS, *ENTRANTS])
    answered.add_argument("--sound", type=Path, help="folder of sound sessions, which set a rival's threshold")
    answered.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    answered.add_argument("--out", type=Path, default=Path("answers.json"), help="of several: with the name added")
    scored.add_argument("answers", type=Path, nargs=1)
    table.add_argument("answers", type=Path, nargs="+")
    for command in (answered, scored, table):
        command.add_argument("--secret", type=Path, help="default: FOLDER.secret.json")
    return found


def counted(items: Iterable[T], total: int) -> list[T]:
    """All items, with progress on standard error."""
    listed = []
    for item in items:
        listed.append(item)
        print(f"\r{len(listed)}/{total}", end="", file=sys.stderr)
    print(file=sys.stderr)
    return listed


def answer(options: argparse.Namespace) -> None:
    """Writes the answers of every named entrant to every session."""
    folder, names, out = options.folder, options.by, options.out
    rivals = [name for name in names if name != OURS]
    if rivals and options.sound is None:
        raise SystemExit("a rival needs --sound FOLDER, which `write FOLDER --sound` makes")
    parts = {out.with_suffix(".looks"): (folder, names), out.with_suffix(".sound.looks"): (options.sound, rivals)}
    looked: list[list[Look]] = [
        counted(looks(*given, file, options.processes), len(numbers(given[0]))) if given[1] else []
        for file, given in parts.items()
    ]
    for name in names:
        given = answers_by(name, options, *looked)
        file = out.with_stem(f"{out.stem}-{name}") if len(names) > 1 else out
        Answers(name, dict(zip(numbers(folder), given, strict=True))).write(file)
    for file in parts:
        file.unlink(missing_ok=True)


def answers_by(name: str, options: argparse.Namespace, looked: list[Look], sound: list[Look]) -> list[Look]:
    """The answers of one entrant, in the order of the sessions."""
    if name == OURS:
        return [look[name] for look in looked]
    acting: list[list[str]] = [[] for _ in looked]
    if ENTRANTS[name].is_given_cause:
        acting = causes_given(read_secret(options.secret or secret_of(options.folder), options.folder), looked, name)
    threshold = Threshold.of(name, sound)
    return [threshold.answer(look[name], causes) for look, causes in zip(looked, acting, strict=True)]


def mark(options: argparse.Namespace) -> str:
    """The marks of one file of answers, or of several beside one another."""
    secret = read_secret(options.secret or secret_of(options.folder), options.folder)
    given = [read_answers(file) for file in options.answers]
    marked = list(zip(*counted(outcomes(options.folder, secret, given), secret.sessions), strict=True))
    if options.command == "score":
        return marked_table(marked[0])
    return compared([one.by for one in given], marked, secret.sessions)


def main(arguments: list[str] | None = None) -> None:
    """Run one of them."""
    options = parser().parse_args(arguments)
    folder: Path = options.folder
    if options.command == "write":
        secret = drawn(options.sessions, options.seed, sound=options.sound)
        counted(write(folder, secret), secret.sessions)
        secret_of(folder).write_bytes(secret.content)
        print(f"{folder} is to be given away; keep {secret_of(folder)}, SHA-256 {secret.commitment}")
    elif options.command == "answer":
        answer(options)
    else:
        print(mark(options))


if __name__ == "__main__":
    main()
