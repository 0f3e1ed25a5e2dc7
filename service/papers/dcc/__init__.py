"""The certificate for programs: a PTB Digital Calibration Certificate, release 3.3.0 with D-SI 2.2.1. SI throughout."""

from service.kit.printable import document
from service.papers.certificate.words import UNSIGNED, Signed
from service.papers.certified import CertifiedSession
from service.papers.dcc.administrative import administrative
from service.papers.dcc.elements import DCC, NAMESPACES
from service.papers.dcc.measurement import measurement
from service.papers.records import Issue

SCHEMA = "3.3.0"
"""Release of the DCC by PTB; it uses D-SI 2.2.1."""
LOCATION = f"{{{NAMESPACES['xsi']}}}schemaLocation"
LOCATIONS = "{dcc} {dcc}/v{schema}/dcc.xsd {si} {si}/v2.2.1/SI_Format.xsd".format(schema=SCHEMA, **NAMESPACES)
"""Attribute and text with the location of the schema of each namespace."""


def certificate_dcc(found: CertifiedSession, issue: Issue, signed: Signed = UNSIGNED) -> bytes:
    """The certificate as XML; one issue always gives the same bytes."""
    root = DCC.digitalCalibrationCertificate(
        {"schemaVersion": SCHEMA, LOCATION: LOCATIONS},
        administrative(found, issue, signed),
        DCC.measurementResults(measurement(found)),
    )
    return document(root)
