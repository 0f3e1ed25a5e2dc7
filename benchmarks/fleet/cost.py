"""Cost of an answer: processor time of the service and of its database, and the number of queries."""

import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from sqlalchemy import Engine, event

NANO = 1e-9


@dataclass(frozen=True)
class Cost:
    """Cost of one answer."""

    seconds: float
    """Processor time, s: of this process and of the database's."""
    queries: int
    size: int
    """Bytes."""


def cost(answer: Callable[[], int], engine: Engine, server: int, rounds: int) -> Cost:
    """The median of some rounds, after one that is not counted; ``answer`` returns its size, ``server`` is the process
    that started the database's others."""
    answer()
    taken, size = [], 0
    with counted(engine) as statements:
        for _ in range(rounds):
            began = time.process_time() + of_database(server)
            size = answer()
            taken.append(time.process_time() + of_database(server) - began)
    return Cost(statistics.median(taken), round(len(statements) / rounds), size)


def of_database(server: int) -> float:
    """Processor seconds of all processes of a database so far."""
    own = Path(f"/proc/{server}/task/{server}/children").read_text().split()
    return sum(_of_process(child) for child in own)


def _of_process(id: str) -> float:
    """0 of one that has ended meanwhile."""
    try:
        return NANO * int(Path(f"/proc/{id}/schedstat").read_text().split()[0])
    except (FileNotFoundError, ProcessLookupError):
        return 0.0


@contextmanager
def counted(engine: Engine) -> Iterator[list[str]]:
    """The statements that a block sends."""
    found: list[str] = []

    def note(_connection: object, _cursor: object, statement: str, *_: object) -> None:
        found.append(statement)

    event.listen(engine, "before_cursor_execute", note)
    yield found
    event.remove(engine, "before_cursor_execute", note)
