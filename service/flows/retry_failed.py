"""Flow: work beside the requests that failed is asked for again."""

from datetime import datetime

from service.storage import Storage


def retry_failed(storage: Storage, now: datetime, who: str) -> int:
    """Everything that failed and that is still wanted; returns how much that is."""
    with storage.database.writing() as store:
        count = store.failures.try_again() + store.failures.ask_anew(now)
        store.audit.write(now, who, "retry", "failed work", {"pieces": count})
    return count
