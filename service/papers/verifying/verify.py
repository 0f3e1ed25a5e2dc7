"""Steps: a certificate and its session's file → every check, with the printed and the computed values.

The issuing service is not asked: facts that the file does not tell are in the certificate itself.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from lxml import etree

from estimator.errors import SessionError
from estimator.message import say, say_count
from service.kit.printable import Element
from service.papers.dcc import certificate_tree
from service.papers.dcc.digest import parsed, stated_digest, unsealed, with_digest
from service.papers.dcc.elements import NAMESPACES
from service.papers.verifying import document
from service.papers.verifying.again import stated_again, with_reference
from service.papers.verifying.compare import differences, numbers_in
from service.papers.verifying.records import MOST, Check, Outcome, RawFile, Verification, checked
from service.papers.verifying.stated import Printed
from service.settings import VERSION

ROOT = f"{{{NAMESPACES['dcc']}}}digitalCalibrationCertificate"
UNREADABLE = (ValueError, LookupError, ArithmeticError)
"""Errors raised by inputs that somebody changed."""


@dataclass(frozen=True)
class Beside:
    """Optional files for further checks."""

    schema: Path | None = None
    """Folder with ``dcc/v3.3.0/dcc.xsd``."""
    trusted: bytes | None = None
    """The laboratory's certificate of its seal, PEM."""
    reference: RawFile | None = None


def verify(certificate: bytes, raw: RawFile, beside: Beside, now: datetime) -> Verification:
    """Makes every check of a certificate."""
    try:
        root = parsed(certificate)
    except etree.XMLSyntaxError as fault:
        return Verification((Check("XML", Outcome.NOT_CHECKED, (str(fault),)),))
    if root.tag != ROOT or root.getroottree().docinfo.doctype:
        says = say("The file is {tag}, not a Digital Calibration Certificate.", tag=root.tag)
        return Verification((Check("XML", Outcome.NOT_CHECKED, (says,)),))
    printed = Printed(root)
    of_document = (
        document.by_schema(certificate, beside.schema),
        document.contents(root),
        document.seal(certificate, printed, beside.trusted),
        document.named(raw, "file", printed.identified("SHA-256 of the input file")),
    )
    is_other_file = of_document[-1].outcome is Outcome.DIFFERS
    return Verification(of_document if is_other_file else (*of_document, *_numbers(printed, raw, beside, now)))


OLDER = (
    "It was made by a release that did not state what its numbers rest on: neither values and their U nor deviations, "
    "tolerances and verdicts can be computed again."
)
UNSEEN = "The reference, session {session}, is taken as stated: give its file, SHA-256 {sha256}, with --reference."
AS_STATED = (
    "Names, addresses, signatures, the tolerances that were set, the causes that were accepted, the stand's "
    "certificate and the diagnosis with its reservations cannot be computed from the file: only hash and seal protect "
    "them."
)


def _numbers(printed: Printed, raw: RawFile, beside: Beside, now: datetime) -> Iterator[Check]:
    """Every number and word that follows from the file."""
    try:
        inputs = printed.inputs()
        if inputs is None:
            yield Check("numbers", Outcome.NOT_CHECKED, (say(OLDER),))
            return
        reference = inputs.reference
        if reference is not None and beside.reference is not None:
            yield document.named(beside.reference, "reference", reference.sha256)
            inputs = with_reference(inputs, reference, beside.reference, now)
        elif reference is not None:
            says = say(UNSEEN, session=reference.session, sha256=reference.sha256)
            yield Check("reference", Outcome.LEFT_OUT, (says,))
        stated = stated_again(raw, inputs, printed, now)
        tree = certificate_tree(stated, printed.issue(), printed.signers, printed.inputs_document)
        yield _compared(printed, with_digest(tree, stated_digest(printed.root)))
    except SessionError as fault:
        yield Check("numbers", Outcome.NOT_CHECKED, (str(fault),))
    except UNREADABLE as fault:
        yield checked(
            "numbers", say("What the numbers rest on cannot be read in the certificate: {fault}", fault=fault)
        )
    yield Check("findings", Outcome.LEFT_OUT, (say(AS_STATED),))


def _compared(printed: Printed, computed: Element) -> Check:
    found = list(differences(unsealed(printed.root), computed))
    says = [
        say("{place}: printed {printed}, computed {computed}", place=at, printed=stated or "-", computed=other or "-")
        for at, stated, other in found[:MOST]
    ]
    if len(found) > MOST:
        says.append(say_count("One more difference.", "{number} more differences.", len(found) - MOST))
    if found and printed.version != VERSION:
        versions = "The certificate was made by version {made}; this is version {own}, which may compute otherwise."
        says.append(say(versions, made=printed.version, own=VERSION))
    agreed = say("{count} numbers agree within a ten-thousandth of their U.", count=numbers_in(computed))
    return checked("numbers", *says, sound=agreed)
