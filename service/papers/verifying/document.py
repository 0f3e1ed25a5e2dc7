"""Steps: checks of the document itself: schema, hash of the contents, electronic seal; and of a file's hash."""

from itertools import islice
from pathlib import Path

from lxml import etree

from estimator.message import say
from service.errors import ServiceError
from service.kit.printable import Element
from service.papers.dcc import SCHEMA
from service.papers.dcc.digest import SIGNATURE, digest_of, stated_digest
from service.papers.sealing import seal_room
from service.papers.verifying.records import MOST, Check, Outcome, RawFile, checked
from service.papers.verifying.stated import Printed


def by_schema(certificate: bytes, folder: Path | None) -> Check:
    """The check by PTB's schema, where it is given."""
    if folder is None:
        return Check("schema", Outcome.LEFT_OUT, (say("Give the folder of PTB's schema with --schema."),))
    file = folder / "dcc" / f"v{SCHEMA}" / "dcc.xsd"
    try:
        schema = etree.XMLSchema(etree.parse(file, etree.XMLParser(no_network=True)))
    except (OSError, etree.LxmlError) as fault:
        return Check("schema", Outcome.NOT_CHECKED, (say("{file}: {fault}", file=file, fault=fault),))
    schema.validate(etree.fromstring(certificate))
    return checked("schema", *(f"{error.line}: {error.message}" for error in islice(schema.error_log, MOST)))


def contents(root: Element) -> Check:
    """Whether they are those that the certificate's hash was made of."""
    stated = stated_digest(root)
    if stated is None:
        says = say("It was made by a release that stated no hash of a certificate's contents.")
        return Check("contents", Outcome.NOT_CHECKED, (says,))
    computed = digest_of(root)
    wrong = say("SHA-256 of the contents: printed {printed}, computed {computed}", printed=stated, computed=computed)
    return checked("contents", *([wrong] if stated != computed else ()))


NO_SEAL = "It has no electronic seal: nothing in it proves who issued it."
NO_LIBRARY = "A library is missing to check the seal: {fault}. Run pip install 'imu-health[sign]'."
SEAL_GONE = "It states an electronic seal but has none."
ANYBODY = (
    "The seal of {owner} holds. To check that it is the laboratory's, give the laboratory's certificate with --trust."
)


def seal(certificate: bytes, printed: Printed, trusted: bytes | None) -> Check:
    """The laboratory's electronic seal."""
    if printed.root.find(SIGNATURE) is None:
        if printed.is_sealed or trusted is not None:
            return checked("seal", say(SEAL_GONE) if printed.is_sealed else say(NO_SEAL))
        return Check("seal", Outcome.LEFT_OUT, (say(NO_SEAL),))
    try:
        owner: str = seal_room("xml").owner_of_seal(certificate, trusted)
    except ServiceError as fault:
        return Check("seal", Outcome.NOT_CHECKED, (say(NO_LIBRARY, fault=fault.__cause__),))
    except ValueError as fault:
        return checked("seal", say("The seal does not hold: {fault}", fault=fault))
    held = say("The seal of {owner} holds.", owner=owner)
    return checked("seal", sound=held if trusted is not None else say(ANYBODY, owner=owner))


def named(raw: RawFile, subject: str, stated: str) -> Check:
    """Whether a file is the one that the certificate names."""
    other = "{file} is another file: SHA-256 {computed}, the certificate names {stated}"
    wrong = say(other, file=raw.name, computed=raw.sha256, stated=stated or "-")
    return checked(subject, *([wrong] if stated != raw.sha256 else ()))
