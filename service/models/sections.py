"""Accepted causes of a stand or a unit type, as lines of a table."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from service.diagnosis.words.causes import cause_on
from service.diagnosis.words.gain import gain_in_words
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
    gain: str
    """Gain from the cause, in one sentence."""


def gain_of(revision: ModelRevision) -> str:
    """The gain of an accepted cause for its sensors in the session that showed it; empty where none was measured."""
    evidence = revision.evidence
    return "" if evidence is None or evidence.gain is None else gain_in_words(evidence.gain, revision.sensors)


def accepted_causes(revisions: Sequence[ModelRevision]) -> tuple[AcceptedCause, ...]:
    """Lines in the order of the revisions."""
    return tuple(
        AcceptedCause(
            revision=revision.id,
            name=cause_on(revision.cause, revision.sensors),
            session=revision.session,
            who=revision.accepted_by,
            at=revision.accepted_at,
            note=revision.note,
            gain=gain_of(revision),
        )
        for revision in revisions
    )
