"""What a Digital Calibration Certificate states beside its numbers, in the words of the paper."""

from collections.abc import Iterator

from service.judging.words import verdict_in_words
from service.kit.names import day_of
from service.kit.xml import Element
from service.papers.certified import CertifiedSession
from service.papers.dcc.elements import DCC, conformity, english
from service.papers.records import Traceability, TraceState
from service.papers.words import RELATES, WHOLE, draft_in_words, lacks, uncertainty_in_words
from service.sessions.decision import nominal_factor_of
from service.sessions.records import StoredSession
from service.sessions.words.conditions import condition_of

NOTHING_JUDGED = "none: nothing was there to judge it by"
TRACEABLE = {TraceState.TRACEABLE: "true", TraceState.INTERRUPTED: "false"}
"""Of a chain that is not on record nothing is claimed."""


def statements(found: CertifiedSession) -> Iterator[Element]:
    """In the order of the paper."""
    session, decisions = found.report.session, found.report.decisions
    draft = draft_in_words(lacks(found.laboratory, found.customer, dated=found.source.started_at is not None))
    if session.simulated:
        yield _statement(
            "Simulated", "SIMULATED: not a measurement of real hardware, and not a calibration certificate."
        )
    if draft:
        yield _statement("Draft", draft)
    yield _verdict(session)
    judged = bool(decisions) and not session.is_reference
    rule = f"{decisions[0].rule}; guard band w = U." if judged else NOTHING_JUDGED
    yield _statement("Decision rule", rule)
    yield _statement("Reference session", _reference(found))
    yield _chain("Traceability", found.traceability)
    if found.reference is not None:
        yield _chain("Traceability of the reference session", found.reference.traceability)
    yield _statement("Uncertainty", uncertainty_in_words(found.report.calibration, nominal_factor_of(decisions)))
    yield _statement("Item", RELATES)
    yield _statement("Reproduction", WHOLE)
    yield _statement("What the simulation gets wrong", found.diagnosis.summary)


def _reference(found: CertifiedSession) -> str:
    if found.reference is None:
        return "none: this session is a reference itself, or there was none"
    other = found.reference.session
    return f"session {other.id} of {day_of(other.started_at)}, model revision {other.revision}"


def _verdict(session: StoredSession) -> Element:
    said = verdict_in_words(condition_of(session.verdict, is_reference=session.is_reference), session.reservations)
    verdict = None if session.is_reference else session.verdict
    told = english("declaration", f"{said}. {session.reason}")
    return DCC.statement(english("name", "Verdict"), told, *conformity(verdict))


def _chain(name: str, chain: Traceability) -> Element:
    claimed = [DCC.traceable(TRACEABLE[chain.state])] if chain.state in TRACEABLE else []
    return DCC.statement(english("name", name), *claimed, english("declaration", chain.text))


def _statement(name: str, declaration: str) -> Element:
    return DCC.statement(english("name", name), english("declaration", declaration))
