"""Environment of changes of records: stores, clock, and the person.

It is the one entry of the API and of the pages. The diagnosis is asked for within the transaction that stores, and made
in the background.
"""

from collections.abc import Callable
from dataclasses import dataclass

from service.jobs.changes import NO_HOOKS, UploadHooks
from service.kit.metrics import Metrics
from service.storage import Storage


@dataclass(frozen=True)
class Reception:
    """Environment of receiving files and changing records."""

    storage: Storage
    coverage_factor: float
    metrics: Metrics
    ring: Callable[[], None]
    """Notified when there are sessions to be diagnosed."""
    who: str = "crew"
    """Person who sends the files."""
    is_dated_later: bool = False
    """Whether the unit's dates are worked out in the background."""
    course: UploadHooks = NO_HOOKS
    """Hooks at the steps of an upload."""
