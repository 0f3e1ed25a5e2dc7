"""The boundary of work beside the requests: what fails is told, counted and tried again later, and the rest goes on."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager

from estimator.errors import SessionError
from service.errors import FAULTS as PROGRAM_FAULTS
from service.errors import ServiceError
from service.log import log
from service.metrics import Metrics
from service.storage.faults import DATABASE_FAULTS

FORESEEN = (ServiceError, SessionError, *DATABASE_FAULTS)
"""A store that is away or refuses, a file that cannot be read: told in one line."""
FAULTS = (*PROGRAM_FAULTS, EOFError, MemoryError, OSError, RuntimeError)
"""What a mistake in the program or a machine in need ends in: told with its traceback. Only a thread that outlives it
watches the rest of the fleet."""

Alone = Callable[[str, str], AbstractContextManager[None]]
"""How one piece of work is done: what is done, and on which stand or unit."""


class Guard:
    """Counts what fails, and lets the rest go on."""

    def __init__(self, metrics: Metrics) -> None:
        self._metrics = metrics
        self.failed = 0
        """Pieces of work that failed so far."""

    @contextmanager
    def alone(self, doing: str, place: str) -> Iterator[None]:
        """A piece of work whose failure ends here."""
        try:
            yield
        except FORESEEN as fault:
            log.warning("background work failed", doing=doing, place=place, reason=str(fault))
            self._count(doing, fault)
        except FAULTS as fault:
            log.error("background work failed", doing=doing, place=place, exc_info=fault)
            self._count(doing, fault)

    def _count(self, doing: str, fault: BaseException) -> None:
        self.failed += 1
        self._metrics.count_fault(doing, type(fault).__name__)


@contextmanager
def plainly(doing: str, place: str) -> Iterator[None]:
    """A piece of work whose failure is the caller's."""
    yield
