"""Lives lives of a running service by chance, on both databases side by side, and writes what that found.

`python -m tests.lives --minutes 60`; one of them again: `python -m tests.lives --engine sqlite --seed 12 --steps 40`.
"""

import argparse
import json
import signal
import subprocess
import sys
import tempfile
import traceback
from collections import Counter
from collections.abc import Callable
from contextlib import AbstractContextManager
from datetime import UTC, datetime
from pathlib import Path
from random import SystemRandom
from time import monotonic
from typing import Any

from tests.databases import Databases, postgres_databases, sqlite_databases
from tests.lives.life import LONG, Size, whole_life
from tests.lives.report import write
from tests.lives.world import FindError, World

ENGINES: dict[str, Callable[[], AbstractContextManager[Databases]]] = {
    "sqlite": sqlite_databases,
    "postgresql": postgres_databases,
}


def main() -> int:
    """Exit code 1 where anything was found."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--minutes", type=float, default=60)
    asked.add_argument("--steps", type=int, default=LONG.steps)
    asked.add_argument("--engine", choices=ENGINES)
    asked.add_argument("--seed", type=int, help="one life only")
    asked.add_argument("--lines", type=Path, help="where a line a life goes")
    given = asked.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))  # so that no service is left
    if given.engine is None:
        return side_by_side(given.minutes, given.steps)
    found = lives(given.engine, given.minutes, given.steps, given.seed, given.lines)
    return int(found)


def side_by_side(minutes: float, steps: int) -> int:
    """Runs both databases at once, and writes the table of the results."""
    with tempfile.TemporaryDirectory(prefix="imu-lives-") as folder:
        files = {engine: Path(folder) / engine for engine in ENGINES}
        command = (sys.executable, "-m", "tests.lives", "--minutes", str(minutes), "--steps", str(steps))
        running = [
            subprocess.Popen([*command, "--engine", engine, "--lines", str(file)]) for engine, file in files.items()
        ]
        codes = [process.wait() for process in running]
        made = {
            engine: [json.loads(line) for line in file.read_text("utf-8").splitlines()] if file.exists() else []
            for engine, file in files.items()
        }
    write(made, minutes, datetime.now(UTC))
    return int(any(codes))


def lives(engine: str, minutes: float, steps: int, only: int | None, lines: Path | None) -> bool:
    """Life after life until the time is over; whether anything was found."""
    end, any_found = monotonic() + 60 * minutes, False
    with ENGINES[engine]() as databases:
        while True:
            number = SystemRandom().randrange(1, 2**31) if only is None else only
            life = one_life(databases, number, steps)
            any_found = any_found or bool(life["find"])
            print(f"{engine} --seed {number} --steps {steps}: {life['find'] or 'nothing found'}", flush=True)
            if life["find"]:
                print("\n".join(life["journal"]), flush=True)
            if lines is not None:
                with lines.open("a", encoding="utf-8") as file:
                    file.write(json.dumps(life) + "\n")
            if only is not None or monotonic() > end:
                return any_found


def one_life(databases: Databases, number: int, steps: int) -> dict[str, Any]:
    """The result of one life; whatever breaks it is a find, and the next one begins."""
    worlds, find = list[World](), ""
    with tempfile.TemporaryDirectory(prefix="imu-life-", ignore_cleanup_errors=True) as folder:
        try:
            whole_life(databases, Path(folder), number, Size(steps, LONG.pages), worlds.append)
        except FindError as error:
            find = str(error)
        except Exception:  # noqa: BLE001 - a fault of the test itself ends one life and not the hour
            find = traceback.format_exc()
    counts = sum((world.counts for world in worlds), Counter[str]())
    return {
        "seed": number,
        "steps": steps,
        "find": find,
        "counts": counts,
        "refused": sum((world.refused for world in worlds), Counter[str]()),
        "processor": sum(world.service.processor for world in worlds),
        "journal": [line for world in worlds for line in world.journal],
    }


if __name__ == "__main__":
    sys.exit(main())
