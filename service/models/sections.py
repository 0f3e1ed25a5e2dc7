"""Accepted causes of a stand or a unit type, as lines of a table."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from service.diagnosis.words.causes import cause_on
from service.models.records import ModelRevision


@dataclass(frozen=True)
class AcceptedCause:
    """A cause that an engineer accepted into a model."""

    revision: int
    name: str
    session: str
    who: str
    at: datetime
    note: str


def accepted_causes(revisions: Sequence[ModelRevision]) -> tuple[AcceptedCause, ...]:
    """Lines in the order of the revisions."""
    return tuple(
        AcceptedCause(
            revision.id,
            cause_on(revision.cause, revision.sensors),
            revision.session,
            revision.accepted_by,
            revision.accepted_at,
            revision.note,
        )
        for revision in revisions
    )
