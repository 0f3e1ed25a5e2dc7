"""Checks of a certificate and their outcomes."""

from dataclasses import dataclass
from enum import StrEnum
from hashlib import sha256

MOST = 20
"""Differences that are listed."""


class Outcome(StrEnum):
    """Outcome of a check."""

    AGREES = "agrees"
    DIFFERS = "differs"
    NOT_CHECKED = "cannot be checked"
    LEFT_OUT = "not asked for"
    """The check takes another file or setting; it decides nothing."""


@dataclass(frozen=True)
class Check:
    """One check."""

    subject: str
    outcome: Outcome
    says: tuple[str, ...] = ()
    """Sentences: the result, every difference, or the reason why it cannot be checked."""


@dataclass(frozen=True)
class Verification:
    """Every check of a certificate, in order."""

    checks: tuple[Check, ...]

    @property
    def outcome(self) -> Outcome:
        """A difference weighs more than what cannot be checked."""
        found = {check.outcome for check in self.checks}
        return next((o for o in (Outcome.DIFFERS, Outcome.NOT_CHECKED) if o in found), Outcome.AGREES)


@dataclass(frozen=True)
class RawFile:
    """A session's file as it was uploaded."""

    name: str
    content: bytes

    @property
    def sha256(self) -> str:
        """SHA-256 of the file, hexadecimal, as certificates state it."""
        return sha256(self.content).hexdigest()


def checked(subject: str, *faults: str, sound: str = "") -> Check:
    """A check that differs where it has faults."""
    says = faults or ((sound,) if sound else ())
    return Check(subject, Outcome.DIFFERS if faults else Outcome.AGREES, says)
