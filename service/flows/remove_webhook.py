"""Flow: an address is told no more; what was on its way to it is given up."""

from datetime import datetime

from service.storage import Storage


def remove_webhook(storage: Storage, id: int, who: str, now: datetime) -> None:
    """Tells an address no more."""
    with storage.database.writing() as store:
        url = store.webhooks.get(id).url
        store.webhooks.remove(id, now)
        store.audit.write(now, who, "remove webhook", str(id), {"url": url})
