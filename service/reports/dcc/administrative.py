"""Who calibrated what, for whom, and what is stated of it."""

from collections.abc import Iterator

from service.records.decision import Verdict
from service.reports.dcc.elements import DCC, NOT_STATED, conformity, english, software
from service.reports.xml import Element
from service.views.certificate import CertifiedSession

UNKNOWN_COUNTRY = "ZZ"
"""User-assigned in ISO 3166-1: the files of sessions name no country."""


def administrative(found: CertifiedSession) -> Element:
    """Everything but the results."""
    operator = DCC.person(english("name", found.report.session.operator))
    return DCC.administrativeData(
        DCC.dccSoftware(software(found.software)),
        _core(found),
        DCC.items(_item(found)),
        DCC.calibrationLaboratory(_contact("contact")),
        DCC.respPersons(DCC.respPerson(operator, DCC.role("operator"), DCC.mainSigner("true"))),
        _contact("customer"),
        DCC.statements(*_statements(found)),
    )


def _core(found: CertifiedSession) -> Element:
    session = found.report.session
    measured = f"{session.started_at:%Y-%m-%d}"
    return DCC.coreData(
        DCC.countryCodeISO3166_1(UNKNOWN_COUNTRY),
        DCC.usedLangCodeISO639_1("en"),
        DCC.mandatoryLangCodeISO639_1("en"),
        DCC.uniqueIdentifier(f"imu-health:{session.id}:{session.revision}"),
        DCC.identifications(_identification("other", session.sha256, "SHA-256 of the input file")),
        DCC.beginPerformanceDate(measured),
        DCC.endPerformanceDate(measured),
        DCC.performanceLocation("laboratory"),
        DCC.issueDate(f"{session.uploaded_at:%Y-%m-%d}"),
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


def _contact(name: str) -> Element:
    return DCC(name, english("name", NOT_STATED), DCC.location(DCC.countryCode(UNKNOWN_COUNTRY)))


def _statements(found: CertifiedSession) -> Iterator[Element]:
    session, decisions = found.report.session, found.report.decisions
    yield _statement("Verdict", session.reason, None if session.is_reference else session.verdict)
    rule = decisions[0].rule if decisions and not session.is_reference else "none: nothing was there to judge it by"
    yield _statement("Decision rule", f"{rule}; guard band w = U.")
    yield _statement("What the simulation gets wrong", found.diagnosis.summary)
    if session.simulated:
        yield _statement("Simulated", "SIMULATED: not a measurement of real hardware.")


def _statement(name: str, declaration: str, verdict: Verdict | None = None) -> Element:
    return DCC.statement(english("name", name), english("declaration", declaration), *conformity(verdict))
