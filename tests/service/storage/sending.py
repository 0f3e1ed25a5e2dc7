"""The ways in which a file comes to what stores it: as bytes where they are few, else landed on the disk."""

from collections.abc import Callable
from datetime import datetime

from service.flows.receive import upload
from service.storage import Storage

Way = Callable[[Storage, bytes, datetime], None]


def as_bytes(storage: Storage, content: bytes, now: datetime) -> None:
    """As a short file comes."""
    upload(storage, content, "a.json", now)


def landed(storage: Storage, content: bytes, now: datetime) -> None:
    """As a long one comes, in two parts."""
    with storage.files.arriving() as place:
        landing, half = place.new(), len(content) // 2
        for part in (content[:half], content[half:]):
            landing.take(part)
            landing.write()
        upload(storage, landing.landed(), "a.json", now)


WAYS: dict[str, Way] = {"as bytes": as_bytes, "landed": landed}
