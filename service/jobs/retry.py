"""Flow: work beside the requests that failed is asked for again."""

from datetime import datetime

from service.jobs.failures_store import Failures
from service.storage import Storage
from service.storage.audit import Audit


def retry_failed(storage: Storage, now: datetime, who: str) -> int:
    """Everything that failed and that is still wanted; returns how much that is."""
    with storage.database.writing() as store:
        count = Failures(store).try_again() + Failures(store).ask_anew(now)
        Audit(store).write(now, who, "retry", "failed work", {"pieces": count})
    return count
