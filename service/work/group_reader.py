"""What a group of sessions shows, for whoever reads it: awaited where it is made beside the requests, else made."""

from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import datetime
from threading import BoundedSemaphore
from time import monotonic

from service.groups.records import Group, GroupAnswer, Level
from service.groups.store import Groups
from service.kit.bell import Bell
from service.kit.failure_words import group_failed
from service.kit.guard import Guard
from service.kit.metrics import Metrics
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.refresh_group import current, give_up, refresh_group
from service.settings import VERSION
from service.storage import Storage
from service.work.kinds import GROUPS

PATIENCE = 15.0
"""Seconds that a program is let wait: a usual group takes some."""
LOOK_EVERY = 0.25
"""Seconds between two looks at what another service may have made."""
MOST_WAITING = 4
"""Requests that wait at a time, of the 40 that are answered at once; others are asked back."""


@dataclass(frozen=True)
class GroupReader:
    """Reads what groups show, of one service."""

    storage: Storage
    clock: Callable[[], datetime]
    bell: Bell
    metrics: Metrics
    workers: int
    """Processes of this service that make answers; 0 where each is made when it is read."""
    places: BoundedSemaphore = field(default_factory=lambda: BoundedSemaphore(MOST_WAITING))

    def read(self, level: Level, name: str, patience: float = PATIENCE) -> GroupAnswer | None:
        """The answer of a group for its sessions of now; None while it is still being made, NotFoundError where there
        is no such unit, unit type or stand."""
        with self.storage.database.reading() as store:
            group = Groups(store).find(level, name)
            known, asked = current(store, group), WorkQueue(store, WorkKind.GROUP).get(group.place)
        if known is not None:
            return known
        if not self.workers:
            return self._made(group)
        if asked is not None and asked.failed:
            return GroupAnswer("", 0, group_failed(asked.failed), "", None, VERSION, self.clock())
        if asked is None:
            with self.storage.database.writing() as store:
                WorkQueue(store, WorkKind.GROUP).ask_each((group.place,), self.clock())
            self.bell.ring()
        if not self.places.acquire(blocking=False):
            return None
        try:
            return self._awaited(group, monotonic() + patience)
        finally:
            self.places.release()

    def _made(self, group: Group) -> GroupAnswer | None:
        """Here, without the sessions at which the program fails; where it fails at the answer itself that is kept."""
        guard = Guard(self.metrics)
        for tried in range(GROUPS.most):
            with guard.at_request(GROUPS.name, group.name):
                refresh_group(self.storage, group, self.clock())
            if guard.failed == tried:
                break
        else:
            give_up(self.storage, group, self.clock())
        with self.storage.database.reading() as store:
            return current(store, group)

    def _awaited(self, group: Group, end: float) -> GroupAnswer | None:
        while True:
            rung = self.bell.rung
            with self.storage.database.reading() as store:
                known = current(store, group)
            left = end - monotonic()
            if known is not None or left <= 0:
                return known
            self.bell.wait(rung, min(left, LOOK_EVERY))
