"""Work beside the requests that has failed."""

from dataclasses import dataclass
from enum import StrEnum

from service.kit.answer import answer


class FailedKind(StrEnum):
    """What is done beside the requests."""

    DIAGNOSIS = "diagnosis"
    """Of a session."""
    OUTLOOK = "outlook"
    """Of a unit: its drift, its forecast and its due date."""
    DERIVATION = "derivation"
    """Of a unit: verdicts after a change of its records."""
    GROUP = "group"
    """What the sessions of a unit, a unit type or a stand show together."""
    SUMMARY = "summary"
    """How the units of a type drift, or how stands stand."""
    RECOMPUTATION = "recomputation"
    """Of a unit's sessions under another model."""
    JOB = "job"
    """Long work that somebody asked for."""
    MESSAGE = "message"
    """To another program."""


@answer
@dataclass(frozen=True)
class Failed:
    """One piece of work beside the requests that has failed."""

    kind: FailedKind
    """What is done."""
    of: str
    """Session, unit, group, job or address."""
    why: str
    """Why it failed, in short; the log says more."""
