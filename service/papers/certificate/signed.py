"""The names under a certificate, as the paper prints them; a line to sign by hand where nobody has signed yet."""

from dataclasses import dataclass

from estimator.message import say
from service.papers.records import Meaning, Signature
from service.papers.words import BOUND, STATES, done_by, moment_of

MEASURED = "Measured by"
"""Signed by hand: whoever measured need not have an account."""


@dataclass(frozen=True)
class Signed:
    """Who signed an issue, and whose seal its file will carry."""

    signatures: tuple[Signature, ...] = ()
    sealed_by: str = ""
    """Empty where it has none."""


UNSIGNED = Signed()
"""An issue that nobody has signed."""


@dataclass(frozen=True)
class SignatureLine:
    """One place for a name."""

    by: str
    who: str
    """Empty where it is left for a pen."""
    at: str
    states: str
    bound: str


def lines_of(signed: Signed) -> tuple[SignatureLine, ...]:
    """Who measured, reviewed, approved."""
    given = {signature.meaning: _line(signature) for signature in signed.signatures}
    empty = (SignatureLine(done_by(meaning), "", "", "", "") for meaning in Meaning)
    places = tuple(given.get(meaning, place) for meaning, place in zip(Meaning, empty, strict=True))
    return (SignatureLine(MEASURED, "", "", "", ""), *places)


def _line(signature: Signature) -> SignatureLine:
    return SignatureLine(
        by=done_by(signature.meaning),
        who=f"{signature.name} ({signature.login})",
        at=moment_of(signature.signed_at),
        states=STATES[signature.meaning],
        bound=say(BOUND, hash=signature.content_hash),
    )
