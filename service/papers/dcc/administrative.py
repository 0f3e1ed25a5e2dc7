"""Administrative data: laboratory, customer, item, number."""

from collections.abc import Iterator, Sequence
from math import degrees

import numpy as np

from estimator.applied_vector import gravity
from estimator.session import ACCELEROMETER, CalibrationSession
from service.judging.temperature_words import covered_in_words
from service.kit.measures import day_of
from service.kit.printable import Element
from service.papers.certified import StatedSession
from service.papers.dcc.elements import DCC, INPUT, bare_quantity, conformity, english, plain, software
from service.papers.records import NOT_STATED, Issue, Meaning, Signature, Signed, Traceability, TraceState
from service.papers.words import (
    BOUND,
    RELATES,
    STATES,
    WHOLE,
    draft_in_words,
    missing_facts,
    moment_of,
    uncertainty_in_words,
)
from service.sessions.decision import nominal_factor_of

UNKNOWN_COUNTRY = "ZZ"
"""User-assigned in ISO 3166-1: the country of the laboratory is not configured, or the session was simulated. PTB's
rules refuse it, as they should a draft."""

ROLES = {Meaning.REVIEWED: "reviewer", Meaning.APPROVED: "approver"}
"""Role of a signer by the meaning of the signature."""


def administrative(found: StatedSession, issue: Issue, signers: Sequence[Element]) -> Element:
    """Everything but the results."""
    laboratory, customer = found.laboratory, found.customer
    return DCC.administrativeData(
        DCC.dccSoftware(software(found.software)),
        _core(found, issue),
        DCC.items(_item(found)),
        DCC.calibrationLaboratory(_contact("contact", laboratory.name, laboratory.address, laboratory.country)),
        DCC.respPersons(*_people(found.report.session.operator, signers)),
        _contact("customer", customer.name, customer.address, ""),
        DCC.statements(*statements(found)),
    )


def signers_of(signed: Signed) -> tuple[Element, ...]:
    """The signers, as ``respPerson``."""
    return tuple(DCC.respPerson(*_signer(signature, signed.sealed_by)) for signature in signed.signatures)


def _people(operator: str, signers: Sequence[Element]) -> Iterator[Element]:
    """The operator and the signers; the main signer is the approver."""
    approved = any(role.text == ROLES[Meaning.APPROVED] for signer in signers for role in signer.iter("{*}role"))
    yield DCC.respPerson(*_operator(operator, signs=not approved))
    yield from signers


def _operator(name: str, *, signs: bool) -> Iterator[Element]:
    """An unknown operator is no signer."""
    yield DCC.person(english("name", name))
    yield DCC.role("operator")
    if signs and plain(name) != NOT_STATED:
        yield DCC.mainSigner("true")


def _signer(signature: Signature, sealed_by: str) -> Iterator[Element]:
    statement = f"{STATES[signature.meaning]} {moment_of(signature.signed_at)}. "
    yield DCC.person(english("name", signature.name))
    yield DCC.description(DCC.content(statement + BOUND.format(hash=signature.content_hash), lang="en"))
    yield DCC.role(ROLES[signature.meaning])
    if signature.meaning is Meaning.APPROVED:
        yield DCC.mainSigner("true")
        yield DCC.cryptElectronicSeal("true" if sealed_by else "false")


def _core(found: StatedSession, issue: Issue) -> Element:
    session = found.report.session
    measured = f"{session.started_at:%Y-%m-%d}"
    return DCC.coreData(
        DCC.countryCodeISO3166_1(UNKNOWN_COUNTRY if session.simulated else found.laboratory.country or UNKNOWN_COUNTRY),
        DCC.usedLangCodeISO639_1("en"),
        DCC.mandatoryLangCodeISO639_1("en"),
        DCC.uniqueIdentifier(issue.number),
        DCC.identifications(
            _identification("other", session.id, "Session"),
            _identification("other", session.sha256, "SHA-256 of the input file"),
        ),
        DCC.beginPerformanceDate(measured),
        DCC.endPerformanceDate(measured),
        DCC.performanceLocation("other" if found.laboratory.place else "laboratory"),
        DCC.issueDate(f"{issue.issued_at:%Y-%m-%d}"),
        *_replaced(issue),
    )


def _replaced(issue: Issue) -> Iterator[Element]:
    if issue.replaces is not None:
        yield DCC.reportAmendedSubstituted(
            DCC.typeOfChange("substituted"), DCC.replacedUniqueIdentifier(issue.replaces)
        )


def _item(found: StatedSession) -> Element:
    unit = found.report.session.unit
    return DCC.item(
        english("name", f"Inertial measurement unit {unit}"),
        DCC.manufacturer(english("name", NOT_STATED)),
        DCC.model(found.type_name),
        DCC.identifications(_identification("manufacturer", unit, "Serial number")),
    )


def _identification(issuer: str, value: str, name: str) -> Element:
    return DCC.identification(DCC.issuer(issuer), DCC.value(value), english("name", name))


def _contact(element: str, name: str, address: str, country: str) -> Element:
    """The address as one text: its parts are not recorded."""
    codes = [DCC.countryCode(country)] if country else []
    return DCC(element, english("name", name), DCC.location(*codes, english("further", address)))


CELSIUS, DEGREE, METRE, SECOND = r"\degreecelsius", r"\degree", r"\metre", r"\second"
ELEVATIONS = {
    "alpha": "Elevation α of the head's axis above the horizon",
    "chi": "Elevation χ of the head's axis above the plane orthogonal to the Earth's axis",
}
"""Setting of a stand, by attribute."""


def conditions(source: CalibrationSession) -> Element:
    """Every known condition; also that the temperature was not recorded."""
    return DCC.influenceConditions(_temperature(source), *_power_on(source), *_site(source), *_elevations(source))


def _condition(name: str, *data: Element) -> Element:
    return DCC.influenceCondition(english("name", name), DCC.data(*data))


def _temperature(source: CalibrationSession) -> Element:
    if source.temperature is None:
        return _condition("Temperature", english("text", "not recorded"))
    extremes = (("lowest", np.min(source.temperature)), ("highest", np.max(source.temperature)))
    return _condition("Temperature", *(bare_quantity(name, float(value), CELSIUS) for name, value in extremes))


def _power_on(source: CalibrationSession) -> Iterator[Element]:
    if source.time_since_power_on is not None:
        since = bare_quantity("from switching on to the first reading", source.time_since_power_on, SECOND)
        yield _condition("Time since power-on", since)


def _site(source: CalibrationSession) -> Iterator[Element]:
    site = source.site
    if site.latitude is not None:
        latitude = bare_quantity("latitude", degrees(site.latitude), DEGREE)
        yield _condition("Site", latitude, bare_quantity("height", site.height, METRE))
    if any(sensor.kind == ACCELEROMETER for sensor in source.sensors):
        origin = "measured" if site.gravity is not None else "by the formula for latitude and height"
        yield _condition(f"Gravity, {origin}", bare_quantity("gravity", gravity(site), INPUT[True]))


def _elevations(source: CalibrationSession) -> Iterator[Element]:
    for attribute, name in ELEVATIONS.items():
        angle = None if source.stand is None else getattr(source.stand, attribute)
        if angle is not None:
            yield _condition(name, bare_quantity("elevation", degrees(angle), DEGREE))


NOTHING_JUDGED = "none: nothing was there to judge it by"
TRACEABLE = {TraceState.TRACEABLE: "true", TraceState.INTERRUPTED: "false"}
"""Claims of traceability by state; none for a chain that is not on record."""


def statements(found: StatedSession) -> Iterator[Element]:
    """The statements of the certificate, in the order of the paper."""
    session, decisions = found.report.session, found.report.decisions
    draft = draft_in_words(missing_facts(found.laboratory, found.customer, dated=found.source.started_at is not None))
    if session.simulated:
        yield _statement(
            "Simulated", "SIMULATED: not a measurement of real hardware, and not a calibration certificate."
        )
    if draft:
        yield _statement("Draft", draft)
    yield _verdict(found)
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
    yield _statement("Temperatures covered", covered_in_words(found.temperatures))
    yield _statement("Diagnosis", found.finding)


def _reference(found: StatedSession) -> str:
    if found.reference is None:
        return "none: this session is a reference itself, or there was none"
    reference = found.reference
    return f"session {reference.session} of {day_of(reference.started_at)}, model revision {reference.model.revision}"


def _verdict(found: StatedSession) -> Element:
    session = found.report.session
    verdict = None if session.is_reference else session.verdict
    declaration = english("declaration", f"{found.said}. {session.reason}")
    return DCC.statement(english("name", "Verdict"), declaration, *conformity(verdict))


def _chain(name: str, chain: Traceability) -> Element:
    claim = [DCC.traceable(TRACEABLE[chain.state])] if chain.state in TRACEABLE else []
    return DCC.statement(english("name", name), *claim, english("declaration", chain.text))


def _statement(name: str, declaration: str) -> Element:
    return DCC.statement(english("name", name), english("declaration", declaration))
