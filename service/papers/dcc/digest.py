"""The hash of a certificate's contents: whoever changes a word of it must also change this.

It is the SHA-256 of the canonical XML (C14N 1.0, comments included) of the document without its electronic seal and
white space between elements, with the text of the hash itself left empty.
"""

from hashlib import sha256

from lxml import etree

from service.kit.printable import Element
from service.papers.dcc.elements import DCC, NAMESPACES, english

SIGNATURE = "{http://www.w3.org/2000/09/xmldsig#}Signature"
NAME = "SHA-256 of the contents of this certificate"


def parsed(content: bytes) -> Element:
    """A document without white space between elements; entities stay unread. XMLSyntaxError for no XML."""
    parser = etree.XMLParser(remove_blank_text=True, resolve_entities=False, no_network=True)
    root: Element = etree.fromstring(content, parser)
    return root


def unsealed(root: Element) -> Element:
    """A copy without electronic seal."""
    bare = parsed(etree.tostring(root))
    for seal in bare.findall(SIGNATURE):
        bare.remove(seal)
    return bare


def with_digest(root: Element, stated: str | None = None) -> Element:
    """The certificate with the hash of its contents as its last identification; ``stated`` stands in its place."""
    place = root.find("dcc:administrativeData/dcc:coreData/dcc:identifications", NAMESPACES)
    assert place is not None
    value = DCC.value("-")
    place.append(DCC.identification(DCC.issuer("other"), value, english("name", NAME)))
    value.text = digest_of(root) if stated is None else stated
    return root


def stated_digest(root: Element) -> str | None:
    """The hash that a certificate states; None for one of a release that stated none."""
    value = _value_of(root)
    return None if value is None else value.text


def digest_of(root: Element) -> str:
    """The hash of a certificate's contents."""
    bare = unsealed(root)
    value = _value_of(bare)
    if value is not None:
        value.text = None
    return sha256(etree.tostring(bare, method="c14n")).hexdigest()


def _value_of(root: Element) -> Element | None:
    for identification in root.iterfind(".//dcc:coreData/dcc:identifications/dcc:identification", NAMESPACES):
        if identification.findtext("dcc:name/dcc:content", None, NAMESPACES) == NAME:
            return identification.find("dcc:value", NAMESPACES)
    return None
