"""``python -m benchmarks.blind write FOLDER``, ``answer FOLDER``, ``score FOLDER ANSWERS``: docs/diagnosis/blind.md."""

import argparse
import os
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TypeVar

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.blind.answer import answered
from benchmarks.blind.folder import Answers, drawn, numbers, read_answers, read_secret, write
from benchmarks.blind.marks import marks, outcomes

T = TypeVar("T")


def secret_of(folder: Path) -> Path:
    """The file that is not given away: beside the folder."""
    return folder.with_name(f"{folder.name}.secret.json")


def parser() -> argparse.ArgumentParser:
    """Three commands."""
    found = argparse.ArgumentParser(prog="python -m benchmarks.blind", description=__doc__)
    commands = found.add_subparsers(dest="command", required=True)
    for name in ("write", "answer", "score"):
        commands.add_parser(name).add_argument("folder", type=Path)
    commands.choices["write"].add_argument("--sessions", type=int, default=1000)
    commands.choices["write"].add_argument("--seed", type=int, help="makes an open benchmark, which anybody can mark")
    commands.choices["answer"].add_argument("--processes", type=int, default=os.cpu_count() or 1)
    commands.choices["answer"].add_argument("--out", type=Path, default=Path("answers.json"))
    commands.choices["score"].add_argument("answers", type=Path)
    commands.choices["score"].add_argument("--secret", type=Path, help="default: FOLDER.secret.json")
    return found


def counted(items: Iterable[T], total: int) -> list[T]:
    """All items, with progress on standard error."""
    listed = []
    for item in items:
        listed.append(item)
        print(f"\r{len(listed)}/{total}", end="", file=sys.stderr)
    print(file=sys.stderr)
    return listed


def main(arguments: list[str] | None = None) -> None:
    """Run one of them."""
    options = parser().parse_args(arguments)
    folder: Path = options.folder
    if options.command == "write":
        secret = drawn(options.sessions, options.seed)
        counted(write(folder, secret), secret.sessions)
        secret_of(folder).write_bytes(secret.content)
        print(f"{folder} is to be given away; keep {secret_of(folder)}, SHA-256 {secret.commitment}")
    elif options.command == "answer":
        given = counted(answered(folder, options.processes), len(numbers(folder)))
        Answers("imu-health", dict(given)).write(options.out)
    else:
        secret = read_secret(options.secret or secret_of(folder), folder)
        print(marks(counted(outcomes(folder, secret, read_answers(options.answers)), secret.sessions)))


if __name__ == "__main__":
    main()
