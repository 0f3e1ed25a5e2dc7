"""What a certificate states, as one hash: another number is due when it changes, and only then."""

import json
from dataclasses import asdict, replace
from datetime import UTC, datetime
from hashlib import sha256

from service.papers.certificate.words import certificate
from service.papers.certified import CertifiedSession
from service.papers.changes import Statement
from service.papers.records import Issue

UNISSUED = Issue("", "", 0, datetime(1970, 1, 1, tzinfo=UTC), "", None, "")
"""Stands in for an issue while what it states is being hashed."""


def statement_of(found: CertifiedSession) -> Statement:
    """What is about to be issued: the words of the paper, and every number in full that paper or XML rests on.

    When its records were received is no part of it: the same records state the same, in whatever order they came.
    """
    session = found.report.session
    report = replace(found.report, session=replace(session, uploaded_at=UNISSUED.issued_at))
    words = certificate(replace(found, report=report), UNISSUED)
    parts = (
        json.dumps(asdict(words), sort_keys=True).encode(),
        found.calibration_json,
        repr(found.report.decisions).encode(),
        repr(found.history).encode(),
    )
    digest = sha256(b"".join(sha256(part).digest() for part in parts)).hexdigest()
    return Statement(session.unit, session.id, session.revision, digest, is_specimen=session.simulated)
