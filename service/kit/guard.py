"""The boundary of work in the background: failures are logged, counted and tried again later, and the rest goes on.

Failures of an upload or a store are foreseen, and described where they happen. Everything else is a fault of the
program, and only here is it caught: logged with its traceback and its place, so that the caller can count it and keep
the failure.
"""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass

from estimator.errors import SessionError
from service.errors import ServiceError
from service.kit.failure import AT_FAULT
from service.kit.log import log
from service.kit.metrics import Metrics

FORESEEN = (ServiceError, SessionError)
"""A store that is away or full, a file that cannot be read: logged in one line. What else a database refuses is a fault
of the program."""
Alone = Callable[[str, str], AbstractContextManager[None]]
"""Context of one piece of work, from its kind and its stand or unit."""


@dataclass(frozen=True)
class Failure:
    """Reason why a piece of work is not done."""

    fault: str
    reason: str
    is_foreseen: bool = True
    """False where the program failed or its process died: that is tried again only a few times."""


class Met:
    """Outcome of a piece of work."""

    failure: Failure | None = None


@contextmanager
def unforeseen(doing: str, place: str) -> Iterator[Met]:
    """A piece of work whose unforeseen failure ends here."""
    met = Met()
    try:
        yield met
    except FORESEEN:
        raise
    except Exception as fault:  # noqa: BLE001 - nobody can say what a mistake raises, and what it was at must outlive it
        log.error("background work failed", doing=doing, place=place, exc_info=fault)
        met.failure = Failure(type(fault).__name__, AT_FAULT, is_foreseen=False)


@contextmanager
def ending_here(doing: str, place: str) -> Iterator[Met]:
    """A piece of work of which every failure ends here."""
    outcome = Met()
    try:
        with unforeseen(doing, place) as met:
            yield outcome
        outcome.failure = met.failure
    except FORESEEN as fault:
        outcome.failure = Failure(type(fault).__name__, str(fault))


@contextmanager
def kept(keep: Callable[[str], None]) -> Iterator[None]:
    """A piece of work whose failure is kept with its reason, and then goes its way."""
    try:
        yield
    except Exception as fault:  # raised again: any failure is first kept with the work that failed
        keep(str(fault) if isinstance(fault, FORESEEN) else AT_FAULT)
        raise


class Guard:
    """Counts what fails, and lets the rest go on."""

    def __init__(self, metrics: Metrics) -> None:
        self._metrics = metrics
        self.failed = 0
        """Pieces of work that failed so far."""

    @contextmanager
    def alone(self, doing: str, place: str) -> Iterator[None]:
        """A piece of work whose failure ends here."""
        with ending_here(doing, place) as met:
            yield
        if met.failure is not None:
            if met.failure.is_foreseen:
                log.warning("background work failed", doing=doing, place=place, reason=met.failure.reason)
            self._count(doing, met.failure)

    @contextmanager
    def at_request(self, doing: str, place: str) -> Iterator[None]:
        """Runs a piece of work for a requester who waits for it, and is shown foreseen failures."""
        with unforeseen(doing, place) as met:
            yield
        if met.failure is not None:
            self._count(doing, met.failure)

    def _count(self, doing: str, failure: Failure) -> None:
        self.failed += 1
        self._metrics.count_fault(doing, failure.fault)


@contextmanager
def plainly(doing: str, place: str) -> Iterator[None]:
    """A piece of work whose failure is the caller's."""
    yield
