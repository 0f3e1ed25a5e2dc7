"""The certificate for programs: a PTB Digital Calibration Certificate, schema 3.2.0 with D-SI 2.1.0. SI throughout."""

from xml.etree.ElementTree import Element

import numpy as np

from estimator.results import SensorCalibration
from service.measures import COVERAGE
from service.records.decision import Decision, Verdict
from service.reports.certificate import title_of
from service.reports.elements import DCC, NOT_STATED, SI, XSI, content, dcc, document
from service.reports.quantities import ONE, deviation_measure, quantity, value_measure
from service.views.certificate import CertifiedSession
from service.words.names import spaced

SCHEMA = "3.2.0"
UNKNOWN_COUNTRY = "ZZ"
"""User-assigned in ISO 3166-1: the files of sessions name no country."""
CONFORMITY = {
    Verdict.PASS: "pass",
    Verdict.CONDITIONAL_PASS: "conditionalPass",
    Verdict.CONDITIONAL_FAIL: "conditionalFail",
    Verdict.FAIL: "fail",
}
"""What could not be decided has no conformity."""


def certificate_dcc(found: CertifiedSession) -> bytes:
    """The certificate as XML; the same record gives the same bytes."""
    root = Element(f"{{{DCC}}}digitalCalibrationCertificate", {"schemaVersion": SCHEMA})
    root.set(f"{{{XSI}}}schemaLocation", f"{DCC} {DCC}/v{SCHEMA}/dcc.xsd {SI} {SI}/v2.1.0/SI_Format.xsd")
    _administrative(dcc(root, "administrativeData"), found)
    _measurement(dcc(dcc(root, "measurementResults"), "measurementResult"), found)
    return document(root)


def _administrative(parent: Element, found: CertifiedSession) -> None:
    session = found.report.session
    _software(dcc(parent, "dccSoftware"), found)
    _core(dcc(parent, "coreData"), found)
    item = dcc(dcc(parent, "items"), "item")
    content(item, "name", f"Inertial measurement unit {session.unit}")
    content(dcc(item, "manufacturer"), "name", NOT_STATED)
    dcc(item, "model", found.unit_type.name)
    _identification(dcc(item, "identifications"), "manufacturer", session.unit, "Serial number")
    _contact(dcc(dcc(parent, "calibrationLaboratory"), "contact"))
    person = dcc(dcc(parent, "respPersons"), "respPerson")
    content(dcc(person, "person"), "name", session.operator)
    dcc(person, "role", "operator")
    dcc(person, "mainSigner", "true")
    _contact(dcc(parent, "customer"))
    _statements(dcc(parent, "statements"), found)


def _software(parent: Element, found: CertifiedSession) -> None:
    software = dcc(parent, "software")
    content(software, "name", "imu-health")
    dcc(software, "release", found.software)
    dcc(software, "type", "application")


def _core(parent: Element, found: CertifiedSession) -> None:
    session = found.report.session
    dcc(parent, "countryCodeISO3166_1", UNKNOWN_COUNTRY)
    dcc(parent, "usedLangCodeISO639_1", "en")
    dcc(parent, "mandatoryLangCodeISO639_1", "en")
    dcc(parent, "uniqueIdentifier", f"imu-health:{session.id}:{session.revision}")
    _identification(dcc(parent, "identifications"), "other", session.sha256, "SHA-256 of the input file")
    dcc(parent, "beginPerformanceDate", f"{session.started_at:%Y-%m-%d}")
    dcc(parent, "endPerformanceDate", f"{session.started_at:%Y-%m-%d}")
    dcc(parent, "performanceLocation", "laboratory")
    dcc(parent, "issueDate", f"{session.uploaded_at:%Y-%m-%d}")


def _identification(parent: Element, issuer: str, value: str, name: str) -> None:
    found = dcc(parent, "identification")
    dcc(found, "issuer", issuer)
    dcc(found, "value", value)
    content(found, "name", name)


def _contact(parent: Element) -> None:
    content(parent, "name", NOT_STATED)
    dcc(dcc(parent, "location"), "countryCode", UNKNOWN_COUNTRY)


def _statements(parent: Element, found: CertifiedSession) -> None:
    session, decisions = found.report.session, found.report.decisions
    _statement(parent, "Verdict", session.reason, None if session.is_reference else session.verdict)
    rule = decisions[0].rule if decisions and not session.is_reference else "none: nothing was there to judge it by"
    _statement(parent, "Decision rule", f"{rule}; guard band w = U.")
    _statement(parent, "What the simulation gets wrong", found.diagnosis.summary)
    if session.simulated:
        _statement(parent, "Simulated", "SIMULATED: not a measurement of real hardware.")


def _statement(parent: Element, name: str, declaration: str, verdict: Verdict | None = None) -> None:
    statement = dcc(parent, "statement")
    content(statement, "name", name)
    content(statement, "declaration", declaration)
    if verdict in CONFORMITY:
        dcc(statement, "conformity", CONFORMITY[verdict])


def _measurement(parent: Element, found: CertifiedSession) -> None:
    session, calibration = found.report.session, found.report.calibration
    content(parent, "name", f"{title_of(session)}: {spaced(session.programme)}")
    method = dcc(dcc(parent, "usedMethods"), "usedMethod")
    content(method, "name", calibration.method)
    content(method, "description", f"Model revision {session.revision}; block axes held by {calibration.gauge}.")
    _software(dcc(parent, "usedSoftware"), found)
    if found.source.stand is not None:
        equipment = dcc(dcc(parent, "measuringEquipments"), "measuringEquipment")
        content(equipment, "name", f"Stand {found.source.stand.id}")
    results = dcc(parent, "results")
    decisions = {(d.sensor, d.parameter): d for d in found.report.decisions if not session.is_reference}
    for sensor in calibration.sensors:
        _sensor(dcc(results, "result"), sensor, found, decisions)


def _sensor(
    parent: Element,
    sensor: SensorCalibration,
    found: CertifiedSession,
    decisions: dict[tuple[str, str], Decision],
) -> None:
    content(parent, "name", f"{sensor.kind} {sensor.name}")
    data = dcc(parent, "data")
    k = found.report.decisions[0].coverage_factor if found.report.decisions else COVERAGE
    for parameter, seen in sensor.observable.items():
        if not seen:
            content(data, "text", f"{parameter}: not observable in this session")
        elif parameter == "axis":
            _axis(data, sensor, k)
        else:
            _scalar(data, sensor, parameter, found, k)
        if (decision := decisions.get((sensor.name, parameter))) is not None:
            _deviation(data, decision)


def _scalar(parent: Element, sensor: SensorCalibration, parameter: str, found: CertifiedSession, k: float) -> None:
    estimate = getattr(sensor, parameter)
    declared = next((s for s in found.source.sensors if s.name == sensor.name), None)
    reading = "" if declared is None else declared.reading_unit
    counted = found.source.count_time is not None and sensor.kind != "accelerometer"
    unit = value_measure(sensor.kind, parameter, reading, counted=counted)
    name = f"{parameter}, in {reading or '1'} per input" if parameter == "scale" else parameter
    quantity(parent, name, estimate.value, unit, estimate.sigma, k)


def _axis(parent: Element, sensor: SensorCalibration, k: float) -> None:
    """Three components; the uncertainty is the turn's along each of them."""
    assert sensor.axis is not None
    spread = np.sqrt(np.diag(sensor.axis_tangents @ sensor.axis_covariance @ sensor.axis_tangents.T))
    vector = dcc(parent, "list")
    content(vector, "name", "input axis, block axes")
    for name, component, sigma in zip("xyz", sensor.axis, spread, strict=True):
        quantity(vector, name, component, ONE, float(sigma), k)


def _deviation(parent: Element, decision: Decision) -> None:
    if decision.deviation is None:
        return
    unit = deviation_measure(decision.kind, decision.parameter)
    name = f"{decision.parameter}, deviation from the reference"
    found = quantity(parent, name, decision.deviation, unit, decision.uncertainty, decision.coverage_factor)
    meta = dcc(dcc(found, "measurementMetaData"), "metaData")
    content(meta, "declaration", f"{decision.rule}: {decision.verdict.value}")
    if decision.verdict in CONFORMITY:
        dcc(meta, "conformity", CONFORMITY[decision.verdict])
    quantity(dcc(meta, "data"), "tolerance", decision.tolerance, unit, None, decision.coverage_factor)
