"""Causes in the model of a stand or a unit type, as lines of a table."""

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
        AcceptedCause(one.id, cause_on(one.cause, one.sensors), one.session, one.accepted_by, one.accepted_at, one.note)
        for one in revisions
    )
