"""The contents of a certificate in words, before its charts are drawn, and its formal parts: number, parties,
traceability, and statements."""

from dataclasses import dataclass

from estimator.health.rule import WITH_SESSION_LEVEL
from estimator.message import joined, say
from service.judging.temperature_words import laws_in_words
from service.kit.measures import coverage_in_words, day_of, spaced
from service.papers.certificate.facts import CertifiedCause, Fact, causes_of, facts_of, record_of
from service.papers.certificate.results import ResultTable, result_tables
from service.papers.certified import CertifiedSession
from service.papers.found_and_left import FoundAndLeft, JudgedChange, moved
from service.papers.records import Issue, Meaning, Signature, Signed
from service.papers.words import (
    BOUND,
    RECEIVED,
    RELATES,
    SAMPLING,
    STATES,
    WHOLE,
    done_by,
    draft_in_words,
    missing_facts,
    moment_of,
    stated,
    title_of,
    uncertainty_in_words,
)
from service.sessions.decision import nominal_factor_of
from service.sessions.words.conditions import CONDITIONS, Condition, but, condition_of
from service.sessions.words.motion import motions_in_words
from service.sessions.words.readings import FitWords, answer_in_words, combination_in_words, fit_in_words


@dataclass(frozen=True)
class Paper:
    """The certificate as a document."""

    number: str
    issued: str
    """Date."""
    replaces: str
    """Number of the replaced certificate; empty for a session's first."""
    draft: str
    """Reason why the paper is only a draft; empty where nothing is missing."""
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
    """The traceability of the session with that of its reference, since every deviation depends on it."""
    if found.reference is None:
        return found.traceability.text
    parts = {"traceability": found.traceability.text, "reference_traceability": found.reference.traceability.text}
    return say("{traceability} Of the reference session: {reference_traceability}", **parts)


def _departures(found: CertifiedSession) -> str:
    if found.report.session.revision:
        return "the accepted causes that are named under Record are part of the model"
    return "none stated"


MEASURED = "Measured by"
"""Signed by hand: the operator need not have an account."""


@dataclass(frozen=True)
class SignatureLine:
    """One line for a signature."""

    by: str
    who: str
    """Name of the signer; empty where it is signed by hand."""
    at: str
    states: str
    bound: str


def lines_of(signed: Signed) -> tuple[SignatureLine, ...]:
    """Operator, reviewer, approver."""
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


@dataclass(frozen=True)
class PairRow:
    """One parameter as found and as left."""

    found: JudgedChange
    left: JudgedChange | None


@dataclass(frozen=True)
class Pair:
    """The unit before and after work on it, against the reference in force before."""

    found: str
    """Session and date."""
    rows: tuple[PairRow, ...]


def pair_of(pair: FoundAndLeft) -> Pair:
    """Decisions of both sessions, in practical units."""
    rows = (PairRow(moved(before), None if after is None else moved(after)) for before, after in pair.decisions)
    return Pair(
        say("session {id} of {started_at}", id=pair.found.id[:12], started_at=day_of(pair.found.started_at)),
        tuple(rows),
    )


@dataclass(frozen=True)
class Certificate:
    """Contents of the paper."""

    title: str
    paper: Paper
    unit: str
    day: str
    simulated: bool
    condition: Condition
    but: str
    """Reservations of the verdict; empty without any."""
    reason: str
    facts: tuple[Fact, ...]
    record: tuple[Fact, ...]
    """Input, method, model, software."""
    sha256: str
    notes: str
    coverage: str
    judged: bool
    """Whether it was judged by a reference and a tolerance."""
    rule: str
    whole_level: bool
    """Whether a number counts as out of tolerance only if it is a change at the level of all of them."""
    states: tuple[Condition, ...]
    """Conditions of the decision rule, best first, each explained once."""
    tables: tuple[ResultTable, ...]
    together: tuple[str, ...]
    """Common motion of all sensors since the reference."""
    stage: str
    """``as found``, ``as left``, or empty."""
    pair: Pair | None
    known: tuple[Fact, ...]
    """Known combinations of parameters that the session cannot separate."""
    force: tuple[Fact, ...]
    """g-sensitivities of gyros, where they were found."""
    diagnosis: str
    causes: tuple[CertifiedCause, ...]
    fit: FitWords
    stand: bool
    software: str


def certificate(found: CertifiedSession, issue: Issue) -> Certificate:
    """Contents of the paper of an issue."""
    session, calibration, decisions = found.report.session, found.report.calibration, found.report.decisions
    k = nominal_factor_of(decisions)
    known = ((s.name, combination_in_words(c, s.kind)) for s in calibration.sensors for c in s.known)
    answers = ((s.name, s.g_sensitivity) for s in calibration.sensors)
    return Certificate(
        title=title_of(session),
        paper=paper_of(found, issue),
        unit=session.unit,
        day=day_of(session.started_at),
        simulated=session.simulated,
        condition=condition_of(session.verdict, is_reference=session.is_reference),
        but=but(session.reservations),
        reason=session.reason,
        facts=facts_of(found),
        record=record_of(found),
        sha256=session.sha256,
        notes=session.notes,
        coverage=coverage_in_words(calibration, k),
        judged=bool(decisions) and not session.is_reference,
        rule=decisions[0].rule if decisions else "",
        whole_level=any(d.rule.startswith(WITH_SESSION_LEVEL) for d in decisions),
        states=tuple(reversed(CONDITIONS)),
        tables=result_tables(found, k),
        together=(*(line.text for line in motions_in_words(found.report.motions, k)), *laws_in_words(decisions)),
        stage=spaced(session.stage or ""),
        pair=None if found.pair is None else pair_of(found.pair),
        known=tuple(Fact(name, words) for name, words in known),
        force=tuple(Fact(name, answer_in_words(answer, k)) for name, answer in answers if answer is not None),
        diagnosis=found.diagnosis.summary,
        causes=causes_of(found),
        fit=fit_in_words(calibration),
        stand=calibration.residuals.beta is not None,
        software=found.software,
    )
