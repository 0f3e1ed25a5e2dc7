"""Causes in the model of a stand or a unit type, as lines of a table."""

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
    """What it gained, in one sentence."""


def gain_of(revision: ModelRevision) -> str:
    """What an accepted cause gained for its sensors in the session that showed it; empty where none was measured."""
    evidence = revision.evidence
    return "" if evidence is None or evidence.gain is None else gain_in_words(evidence.gain, revision.sensors)


def accepted_causes(revisions: Sequence[ModelRevision]) -> tuple[AcceptedCause, ...]:
    """Lines in the order of the revisions."""
    return tuple(
        AcceptedCause(
            revision=one.id,
            name=cause_on(one.cause, one.sensors),
            session=one.session,
            who=one.accepted_by,
            at=one.accepted_at,
            note=one.note,
            gain=gain_of(one),
        )
        for one in revisions
    )
