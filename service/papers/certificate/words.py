"""The contents of a certificate in words, before its charts are drawn."""

from dataclasses import dataclass

from estimator.health.rule import WITH_SESSION_LEVEL
from estimator.message import say
from service.judging.temperature_words import laws_in_words
from service.kit.measures import coverage_in_words, day_of, spaced
from service.papers.certificate.facts import CertifiedCause, Fact, causes_of, facts_of, record_of
from service.papers.certificate.paper import Paper, paper_of
from service.papers.certificate.results import ResultTable, result_tables
from service.papers.certified import CertifiedSession
from service.papers.found_and_left import FoundAndLeft, JudgedChange, moved
from service.papers.records import Issue, Meaning, Signature, Signed
from service.papers.words import BOUND, STATES, done_by, moment_of, title_of
from service.sessions.decision import nominal_factor_of
from service.sessions.words.conditions import CONDITIONS, Condition, but, condition_of
from service.sessions.words.motion import motions_in_words
from service.sessions.words.readings import FitWords, combination_in_words, fit_in_words

MEASURED = "Measured by"
"""Signed by hand: the operator need not have an account."""


@dataclass(frozen=True)
class SignatureLine:
    """One line for a signature."""

    by: str
    who: str
    """Empty where it is signed by hand."""
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
    """Of the decision rule, best first, each explained once."""
    tables: tuple[ResultTable, ...]
    together: tuple[str, ...]
    """Common motion of all sensors since the reference."""
    stage: str
    """``as found``, ``as left``, or empty."""
    pair: Pair | None
    known: tuple[Fact, ...]
    """Known combinations of parameters that the session cannot separate."""
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
        diagnosis=found.diagnosis.summary,
        causes=causes_of(found),
        fit=fit_in_words(calibration),
        stand=calibration.residuals.beta is not None,
        software=found.software,
    )
