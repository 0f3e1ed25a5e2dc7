"""Who calibrated what, for whom, under which number."""

from collections.abc import Iterator

from service.records.paper import NOT_STATED, Issue
from service.reports.dcc.elements import DCC, english, plain, software
from service.reports.dcc.statements import statements
from service.reports.xml import Element
from service.views.certificate import CertifiedSession

UNKNOWN_COUNTRY = "ZZ"
"""User-assigned in ISO 3166-1: nobody set the laboratory's country. PTB's rules refuse it, as they should a draft."""


def administrative(found: CertifiedSession, issue: Issue) -> Element:
    """Everything but the results."""
    own, customer = found.laboratory, found.customer
    return DCC.administrativeData(
        DCC.dccSoftware(software(found.software)),
        _core(found, issue),
        DCC.items(_item(found)),
        DCC.calibrationLaboratory(_contact("contact", own.name, own.address, own.country)),
        DCC.respPersons(DCC.respPerson(*_operator(found.report.session.operator))),
        _contact("customer", customer.name, customer.address, ""),
        DCC.statements(*statements(found)),
    )


def _operator(name: str) -> Iterator[Element]:
    """Nobody whose name is not known signs anything."""
    yield DCC.person(english("name", name))
    yield DCC.role("operator")
    if plain(name) != NOT_STATED:
        yield DCC.mainSigner("true")


def _core(found: CertifiedSession, issue: Issue) -> Element:
    session = found.report.session
    measured = f"{session.started_at:%Y-%m-%d}"
    return DCC.coreData(
        DCC.countryCodeISO3166_1(found.laboratory.country or UNKNOWN_COUNTRY),
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
