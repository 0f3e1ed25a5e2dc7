"""Elements of a Digital Calibration Certificate, built as a tree: no text is ever taken for markup."""

import re
from collections.abc import Iterator

from lxml.builder import ElementMaker

from service.kit.xml import ILLEGAL, Element
from service.papers.records import NOT_STATED
from service.sessions.decision import Verdict

NAMESPACES = {
    "dcc": "https://ptb.de/dcc",
    "si": "https://ptb.de/si",
    "xsi": "http://www.w3.org/2001/XMLSchema-instance",
}
"""Under the prefixes that PTB writes them with."""
NUMBERED = re.compile(r"\d{1,3}(\.\d{1,3}){0,3}")
"""What of a version PTB's rules let stand behind its letter."""
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
    """This program; a version that is more than numbers stands whole in the name."""
    numbers = NUMBERED.match(release)
    shown = numbers[0] if numbers else "0"
    name = "imu-health" if shown == release else f"imu-health {release}"
    return DCC.software(english("name", name), DCC.release(f"v{shown}"), DCC.type("application"))


def conformity(verdict: Verdict | None) -> Iterator[Element]:
    """The schema's word for a verdict, where it has one."""
    if verdict in CONFORMITY:
        yield DCC.conformity(CONFORMITY[verdict])
