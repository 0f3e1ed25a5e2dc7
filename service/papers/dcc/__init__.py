"""The certificate for programs: a PTB Digital Calibration Certificate, release 3.3.0 with D-SI 2.2.1. SI throughout.

Its ``dcc:document`` holds what its numbers can be computed again from beside the session's file; the hash of its own
contents stands among its identifications.
"""

from base64 import b64encode
from collections.abc import Sequence

from service.kit.printable import Element, document
from service.papers.certified import CertifiedSession, StatedSession
from service.papers.dcc.administrative import administrative, signers_of
from service.papers.dcc.digest import with_digest
from service.papers.dcc.elements import DCC, NAMESPACES, english
from service.papers.dcc.inputs import inputs_json
from service.papers.dcc.measurement import measurement
from service.papers.records import UNSIGNED, Issue, Signed

SCHEMA = "3.3.0"
"""Release of the DCC by PTB; it uses D-SI 2.2.1."""
LOCATION = f"{{{NAMESPACES['xsi']}}}schemaLocation"
LOCATIONS = "{dcc} {dcc}/v{schema}/dcc.xsd {si} {si}/v2.2.1/SI_Format.xsd".format(schema=SCHEMA, **NAMESPACES)
"""Attribute and text with the location of the schema of each namespace."""


def certificate_dcc(found: CertifiedSession, issue: Issue, signed: Signed = UNSIGNED) -> bytes:
    """The certificate as XML; one issue always gives the same bytes."""
    inputs = DCC.document(
        english("name", "What the numbers can be computed again from, beside the input file"),
        DCC.fileName("recomputation.json"),
        DCC.mimeType("application/json"),
        DCC.dataBase64(b64encode(inputs_json(found).encode()).decode()),
    )
    return document(with_digest(certificate_tree(found, issue, signers_of(signed), [inputs])))


def certificate_tree(
    found: StatedSession, issue: Issue, signers: Sequence[Element], inputs: Sequence[Element]
) -> Element:
    """The certificate without the hash of its contents."""
    return DCC.digitalCalibrationCertificate(
        {"schemaVersion": SCHEMA, LOCATION: LOCATIONS},
        administrative(found, issue, signers),
        DCC.measurementResults(measurement(found)),
        *inputs,
    )
