"""What a signature under a certificate means, in one way for whoever signs and whoever reads."""

from datetime import datetime

from service.records.signature import Meaning

STATES = {
    Meaning.REVIEWED: "I have checked record, results, uncertainties and statements of this certificate, and have "
    "found nothing against them.",
    Meaning.APPROVED: "I release this certificate in the name of the laboratory.",
}
"""What whoever signs states."""
BOUND = "Signed in imu-health with the password asked again; holds for the content with SHA-256 {hash}."
NO_LONGER = (
    "What certificate {number} rests on has changed since it was {done}: it no longer states what is stored. "
    "The next certificate will have another number, and must be signed anew."
)
CHANGED_HASH = "Certificate {number} was signed under another content than is on record: the database was changed."
NOT_COUNTED = "The session no longer counts: certificate {number} should not be used."


def done_by(meaning: Meaning) -> str:
    """``Reviewed by``."""
    return f"{meaning.capitalize()} by"


def moment_of(at: datetime) -> str:
    """``7 Mar 2026, 09:30 UTC``."""
    return f"{at.day} {at:%b %Y, %H:%M} UTC"
