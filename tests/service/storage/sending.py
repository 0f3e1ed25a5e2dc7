"""The ways in which a file comes to what stores it: as bytes where they are few, else landed on the disk, and then at
once or by a job."""

from collections.abc import Callable
from datetime import datetime
from uuid import uuid4

from service.kit.metrics import Metrics
from service.kit.person import EVERYBODY
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.reception import Reception
from service.sessions.sent import SentFile
from service.storage import Storage
from service.uploads.receive import upload
from service.uploads.take_in import ask_upload, take_in
from service.work.kinds import LEASE

Way = Callable[[Storage, bytes, datetime], None]


def as_bytes(storage: Storage, content: bytes, now: datetime) -> None:
    """Sends a file as a short one comes."""
    upload(storage, content, "a.json", now)


def landed(storage: Storage, content: bytes, now: datetime) -> None:
    """Sends a file as a long one comes, in two parts."""
    with storage.files.arriving() as place:
        landing, half = place.new(), len(content) // 2
        for part in (content[:half], content[half:]):
            landing.take(part)
            landing.write()
        upload(storage, landing.landed(), "a.json", now)


def by_a_job(storage: Storage, content: bytes, now: datetime) -> None:
    """Sends a long file whose sender does not wait: it is acknowledged before it is read."""
    with storage.files.arriving() as place:
        landing = place.new()
        landing.take(content)
        landing.write()
        ask_upload(storage, SentFile("a.json", landing.landed()), EVERYBODY, uuid4().hex, now)


def go_on(storage: Storage, now: datetime) -> None:
    """Takes up open jobs, as a service does that is started again."""
    with storage.database.reading() as store:
        waiting = WorkQueue(store, WorkKind.UPLOAD).waiting(now + LEASE, 100)
    for id in waiting:
        take_in(Reception(storage, 2.0, Metrics(), lambda: None), int(id), now)


WAYS: dict[str, Way] = {"as bytes": as_bytes, "landed": landed, "by a job": by_a_job}
