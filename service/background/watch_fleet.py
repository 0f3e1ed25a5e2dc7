"""Work beside the requests: every outlook, every due date and every stand, looked at now and then."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.background.flag_overdue import flag_overdue
from service.background.flag_shifted_stands import flag_shifted_stands
from service.errors import ServiceError
from service.flows.relearn import relearn
from service.log import log
from service.storage import Storage

FIRST_LOOK, LOOK_EVERY = 20.0, 3600.0
"""Seconds after the start, which has other work, and between two looks: dates fall due by the day."""


def watch_fleet(storage: Storage, clock: Callable[[], datetime], stop: Event) -> None:
    """Looks at every outlook, due date and stand now and then until ``stop`` is set."""
    pause = FIRST_LOOK
    while not stop.wait(pause):
        pause = LOOK_EVERY
        try:
            relearn(storage, clock())
            flag_overdue(storage, clock())
            flag_shifted_stands(storage, clock())
        except ServiceError as fault:
            log.warning("due dates and stands looked at later", reason=str(fault))
