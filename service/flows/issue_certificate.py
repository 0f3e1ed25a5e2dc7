"""Flow: a certificate gets its number. What states the same keeps it; what states something else replaces it."""

from dataclasses import dataclass
from datetime import datetime

from service.records.paper import Issue
from service.storage import Storage

SPECIMEN = "specimen-"
"""Begins the number of what is written of a simulated session: no such number is a certificate's."""


@dataclass(frozen=True)
class Statement:
    """What a certificate is about to state."""

    unit: str
    session: str
    revision: int
    content_hash: str
    """SHA-256 of all of it."""
    is_specimen: bool = False
    """Whether the session was simulated, so that it certifies nothing."""


def issue_certificate(storage: Storage, statement: Statement, now: datetime, *, who: str) -> Issue:
    """The issue that states this: the latest one of the session, or a new one that names the one it replaces."""
    with storage.database.writing() as store:
        store.units.hold(statement.unit)
        issued = store.certificates.of_session(statement.session)
        if issued and issued[-1].content_hash == statement.content_hash:
            return issued[-1]
        new = Issue(
            number=f"{SPECIMEN * statement.is_specimen}{statement.session}-{statement.revision}-{len(issued) + 1}",
            session=statement.session,
            revision=statement.revision,
            issued_at=now,
            who=who,
            replaces=issued[-1].number if issued else None,
            content_hash=statement.content_hash,
        )
        store.certificates.add(new)
        store.audit.write(now, who, "certificate", new.number, {"replaces": new.replaces})
    return new
