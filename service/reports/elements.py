"""XML elements of a Digital Calibration Certificate, built as a tree: no text is ever taken for markup."""

import re
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

DCC, SI, XSI = "https://ptb.de/dcc", "https://ptb.de/si", "http://www.w3.org/2001/XMLSchema-instance"
ILLEGAL = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 cannot hold."""
NOT_STATED = "not stated"

for prefix, namespace in (("dcc", DCC), ("si", SI), ("xsi", XSI)):
    ElementTree.register_namespace(prefix, namespace)


def dcc(parent: Element, name: str, text: str | None = None) -> Element:
    """A child of the namespace dcc; its text without needless space, never empty."""
    child = SubElement(parent, f"{{{DCC}}}{name}")
    if text is not None:
        child.text = plain(text)
    return child


def si(parent: Element, name: str, text: str | None = None) -> Element:
    """A child of the namespace si."""
    child = SubElement(parent, f"{{{SI}}}{name}")
    child.text = text
    return child


def content(parent: Element, name: str, text: str) -> Element:
    """A child that holds a text in English."""
    child = dcc(parent, name)
    dcc(child, "content", text).set("lang", "en")
    return child


def plain(text: str) -> str:
    """The text as the schema's strings must be: no space at the ends, something in it, every character legal."""
    return " ".join(ILLEGAL.sub(lambda found: f"‹U+{ord(found[0]):04X}›", text).split()) or NOT_STATED


def document(root: Element) -> bytes:
    """The file."""
    ElementTree.indent(root)
    written: bytes = ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)
    return written
