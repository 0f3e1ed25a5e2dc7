"""Step: an upload that cannot be used leaves a record of why, and nothing else."""

from collections.abc import Sequence

from estimator.errors import Problem
from service.errors import RefusedError
from service.flows.course import UNFOLLOWED, Course
from service.records.received import Received
from service.storage import Storage

LONGEST_MESSAGE = 1000
"""Characters of a problem that are kept and shown: a hostile file could put megabytes into one."""


def refuse(
    storage: Storage, received: Received, problems: Sequence[Problem], course: Course = UNFOLLOWED
) -> RefusedError:
    """Records the refusal and returns the error to raise, which holds every problem."""
    name, digest = received.filename, received.sha256
    listed = tuple(Problem(_text(p.field), _text(p.message), p.row) for p in problems)
    with storage.database.writing() as store:
        number = store.log.refusal(received.at, name, digest, received.size, listed)
        store.audit.write(received.at, received.who, "refuse", digest, {"filename": name, "problems": len(listed)})
        course.refused(store, number)
    count = "one problem" if len(listed) == 1 else f"{len(listed)} problems"
    return RefusedError(f"{name} cannot be used: {count}. Nothing was stored.", listed)


def _text(message: str) -> str:
    """Printable, so that any database and any reader takes it."""
    return "".join(c if c.isprintable() else "\ufffd" for c in message)[:LONGEST_MESSAGE]
