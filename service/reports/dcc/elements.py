"""Elements of a Digital Calibration Certificate, built as a tree: no text is ever taken for markup."""

from collections.abc import Iterator

from lxml.builder import ElementMaker

from service.records.decision import Verdict
from service.reports.xml import ILLEGAL, Element

NAMESPACES = {
    "dcc": "https://ptb.de/dcc",
    "si": "https://ptb.de/si",
    "xsi": "http://www.w3.org/2001/XMLSchema-instance",
}
"""Under the prefixes that PTB writes them with."""
NOT_STATED = "not stated"
"""Stands where the schema wants a text and the session has none."""
CONFORMITY = {
    Verdict.PASS: "pass",
    Verdict.CONDITIONAL_PASS: "conditionalPass",
    Verdict.CONDITIONAL_FAIL: "conditionalFail",
    Verdict.FAIL: "fail",
}
"""What could not be decided has no conformity."""


def plain(text: str) -> str:
    """The text as the schema's strings must be: no space at the ends, something in it, every character legal."""
    return " ".join(ILLEGAL.sub(lambda found: f"‹U+{ord(found[0]):04X}›", text).split()) or NOT_STATED


def _write(element: Element, text: str) -> None:
    element.text = plain(text)


DCC, SI = (ElementMaker({str: _write}, NAMESPACES[prefix], NAMESPACES) for prefix in ("dcc", "si"))
"""``DCC.name(...)`` makes the element ``dcc:name`` of its children, or of its text as `plain` writes it."""


def english(name: str, text: str) -> Element:
    """An element that holds a text in English."""
    return DCC(name, DCC.content(text, lang="en"))


def software(release: str) -> Element:
    """This program."""
    return DCC.software(english("name", "imu-health"), DCC.release(release), DCC.type("application"))


def conformity(verdict: Verdict | None) -> Iterator[Element]:
    """The schema's word for a verdict, where it has one."""
    if verdict in CONFORMITY:
        yield DCC.conformity(CONFORMITY[verdict])
