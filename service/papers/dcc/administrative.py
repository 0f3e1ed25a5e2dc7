"""Who calibrated what, for whom, under which number."""

from collections.abc import Iterator

from service.kit.xml import Element
from service.papers.certificate.signed import Signed
from service.papers.certified import CertifiedSession
from service.papers.dcc.elements import DCC, english, plain, software
from service.papers.dcc.statements import statements
from service.papers.records import NOT_STATED, Issue, Meaning, Signature
from service.papers.words import BOUND, STATES, moment_of

UNKNOWN_COUNTRY = "ZZ"
"""User-assigned in ISO 3166-1: nobody set the laboratory's country, or nothing was measured anywhere. PTB's rules
refuse it, as they should a draft."""

ROLES = {Meaning.REVIEWED: "reviewer", Meaning.APPROVED: "approver"}
"""Of whoever signed, by what their signature means."""


def administrative(found: CertifiedSession, issue: Issue, signed: Signed) -> Element:
    """Everything but the results."""
    own, customer = found.laboratory, found.customer
    return DCC.administrativeData(
        DCC.dccSoftware(software(found.software)),
        _core(found, issue),
        DCC.items(_item(found)),
        DCC.calibrationLaboratory(_contact("contact", own.name, own.address, own.country)),
        DCC.respPersons(*_people(found.report.session.operator, signed)),
        _contact("customer", customer.name, customer.address, ""),
        DCC.statements(*statements(found)),
    )


def _people(operator: str, signed: Signed) -> Iterator[Element]:
    """Who measured, and who signed; the main signer is who approved it."""
    approved = any(signature.meaning is Meaning.APPROVED for signature in signed.signatures)
    yield DCC.respPerson(*_operator(operator, signs=not approved))
    for signature in signed.signatures:
        yield DCC.respPerson(*_signer(signature, signed.sealed_by))


def _operator(name: str, *, signs: bool) -> Iterator[Element]:
    """Nobody whose name is not known signs anything."""
    yield DCC.person(english("name", name))
    yield DCC.role("operator")
    if signs and plain(name) != NOT_STATED:
        yield DCC.mainSigner("true")


def _signer(signature: Signature, sealed_by: str) -> Iterator[Element]:
    said = f"{STATES[signature.meaning]} {moment_of(signature.signed_at)}. "
    yield DCC.person(english("name", signature.name))
    yield DCC.description(DCC.content(said + BOUND.format(hash=signature.content_hash), lang="en"))
    yield DCC.role(ROLES[signature.meaning])
    if signature.meaning is Meaning.APPROVED:
        yield DCC.mainSigner("true")
        yield DCC.cryptElectronicSeal("true" if sealed_by else "false")


def _core(found: CertifiedSession, issue: Issue) -> Element:
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
    """The certificate that this one takes the place of."""
    if issue.replaces is not None:
        yield DCC.reportAmendedSubstituted(
            DCC.typeOfChange("substituted"), DCC.replacedUniqueIdentifier(issue.replaces)
        )


def _item(found: CertifiedSession) -> Element:
    unit = found.report.session.unit
    return DCC.item(
        english("name", f"Inertial measurement unit {unit}"),
        DCC.manufacturer(english("name", NOT_STATED)),
        DCC.model(found.unit_type.name),
        DCC.identifications(_identification("manufacturer", unit, "Serial number")),
    )


def _identification(issuer: str, value: str, name: str) -> Element:
    return DCC.identification(DCC.issuer(issuer), DCC.value(value), english("name", name))


def _contact(element: str, name: str, address: str, country: str) -> Element:
    """The address as one text: nobody is asked for its parts."""
    codes = [DCC.countryCode(country)] if country else []
    return DCC(element, english("name", name), DCC.location(*codes, english("further", address)))
