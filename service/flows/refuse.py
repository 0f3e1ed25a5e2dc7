"""Step: an upload that cannot be used leaves a record of why, and nothing else."""

from collections.abc import Sequence
from datetime import datetime

from estimator.errors import Problem
from service.errors import RefusedError
from service.ingest.storable import plain_filename
from service.storage import Storage
from service.storage.files import content_hash

LONGEST_MESSAGE = 1000


def refuse(
    storage: Storage, content: bytes, filename: str, problems: Sequence[Problem], now: datetime, who: str
) -> RefusedError:
    """Records the refusal and returns the error to raise, which holds every problem."""
    digest, name = content_hash(content), plain_filename(filename)
    listed = tuple(Problem(_text(p.field), _text(p.message), p.row) for p in problems)
    with storage.database.writing() as store:
        store.log.refusal(now, name, digest, len(content), listed)
        store.log.audit(now, who, "refuse", digest, {"filename": name, "problems": len(listed)})
    count = "one problem" if len(listed) == 1 else f"{len(listed)} problems"
    return RefusedError(f"{name} cannot be used: {count}. Nothing was stored.", listed)


def _text(message: str) -> str:
    """Printable, so that any database and any reader takes it."""
    return "".join(c if c.isprintable() else "\ufffd" for c in message)[:LONGEST_MESSAGE]
