"""The formal parts of a certificate: number, parties, traceability, and statements."""

from dataclasses import dataclass

from estimator.message import joined, say
from service.kit.measures import day_of
from service.papers.certificate.facts import Fact
from service.papers.certified import CertifiedSession
from service.papers.records import Issue
from service.papers.words import (
    RECEIVED,
    RELATES,
    SAMPLING,
    WHOLE,
    draft_in_words,
    missing_facts,
    stated,
    uncertainty_in_words,
)
from service.sessions.decision import nominal_factor_of


@dataclass(frozen=True)
class Paper:
    """The certificate as a document."""

    number: str
    issued: str
    """Date."""
    replaces: str
    """Number of the replaced certificate; empty for a session's first."""
    draft: str
    """Why it is only a draft; empty where nothing is missing."""
    parties: tuple[Fact, ...]
    """Laboratory, customer, place."""
    traceability: str
    interrupted: bool
    """Whether traceability was interrupted at the day of measurement."""
    statements: tuple[Fact, ...]


def paper_of(found: CertifiedSession, issue: Issue) -> Paper:
    """The document of one issue."""
    laboratory, customer = found.laboratory, found.customer
    missing = missing_facts(laboratory, customer, dated=found.source.started_at is not None)
    return Paper(
        number=issue.number,
        issued=day_of(issue.issued_at),
        replaces=issue.replaces or "",
        draft=draft_in_words(missing),
        parties=(
            _party("Laboratory", laboratory.name, laboratory.address, laboratory.country),
            _party("Customer", customer.name, customer.address),
            _party("Place of calibration", laboratory.place or laboratory.address),
            Fact("Date of issue", day_of(issue.issued_at)),
        ),
        traceability=found.traceability.text,
        interrupted=found.traceability.has_expired,
        statements=_statements(found),
    )


def _party(name: str, *parts: str) -> Fact:
    if not any(parts):
        return Fact(name, stated(""))
    return Fact(name, joined(", ", (stated(part) for part in parts)), is_written=True)


def _statements(found: CertifiedSession) -> tuple[Fact, ...]:
    k = nominal_factor_of(found.report.decisions)
    return (
        Fact("Uncertainty", uncertainty_in_words(found.report.calibration, k)),
        Fact("Traceability", _traceability(found)),
        Fact("Item", RELATES),
        Fact("Reproduction", WHOLE),
        Fact("Departures from the method", _departures(found)),
        Fact("Sampling", SAMPLING),
        Fact("Item received", RECEIVED),
        Fact("External providers", "none stated"),
    )


def _traceability(found: CertifiedSession) -> str:
    """With that of the reference, since every deviation depends on it."""
    if found.reference is None:
        return found.traceability.text
    parts = {"traceability": found.traceability.text, "reference_traceability": found.reference.traceability.text}
    return say("{traceability} Of the reference session: {reference_traceability}", **parts)


def _departures(found: CertifiedSession) -> str:
    if found.report.session.revision:
        return "the accepted causes that are named under Record are part of the model"
    return "none stated"
