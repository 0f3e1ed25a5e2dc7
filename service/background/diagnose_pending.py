"""Flow: diagnoses that a crash or an older version left undone, one after another."""

from collections.abc import Callable
from datetime import datetime
from threading import Event

from service.background.guard import Guard
from service.errors import ServiceError
from service.flows.diagnose import InProgress, diagnose
from service.log import log
from service.metrics import Metrics
from service.settings import VERSION
from service.storage import Storage

BATCH = 50
"""Sessions that one query brings."""
PAUSE = 0.05
"""Seconds between two diagnoses, so that requests are not kept waiting."""


def diagnose_pending(
    storage: Storage, clock: Callable[[], datetime], metrics: Metrics, progress: InProgress, stop: Event
) -> None:
    """Diagnoses every session that has none, until ``stop`` is set; what fails is left to its first reader."""
    last, guard = "", Guard(metrics)
    while not stop.is_set():
        try:
            with storage.database.reading() as store:
                waiting = store.sessions.without_diagnosis(last, BATCH, VERSION)
        except ServiceError as fault:
            log.warning("pending diagnoses left to their readers", reason=str(fault))
            return
        if not waiting:
            return
        for id in waiting:
            if stop.wait(PAUSE):
                return
            with guard.alone("pending diagnoses", id):
                diagnose_quietly(storage, id, clock(), progress)
        last = waiting[-1]


def diagnose_quietly(storage: Storage, id: str, now: datetime, progress: InProgress) -> None:
    """Diagnoses a session unless this process is at it; where that is not possible now it stays pending."""
    with progress.claim(id) as ours:
        if not ours:
            return
        try:
            diagnose(storage, id, now)
        except ServiceError as fault:
            log.warning("diagnosis pending", session=id, reason=str(fault))
