"""What changes of records need: stores, clock, who asks.

The one entry of the API and of the pages. The diagnosis is asked for within the transaction that stores, and made
in the background.
"""

from collections.abc import Callable
from dataclasses import dataclass

from service.jobs.changes import NO_HOOKS, UploadHooks
from service.kit.metrics import Metrics
from service.storage import Storage


@dataclass(frozen=True)
class Reception:
    """What receiving takes, apart from the file."""

    storage: Storage
    coverage_factor: float
    metrics: Metrics
    ring: Callable[[], None]
    """Notified when there are sessions to be diagnosed."""
    who: str = "crew"
    """That sends the files."""
    is_dated_later: bool = False
    """Whether the unit's dates are worked out in the background."""
    course: UploadHooks = NO_HOOKS
    """What is done at the steps of an upload."""
