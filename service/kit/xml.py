"""What every XML document of the service needs: characters that it can hold, and its bytes."""

import re
from typing import TypeAlias

from lxml.etree import _Element, tostring

Element: TypeAlias = _Element
"""A part of a tree."""
ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 (section 2.2, Char) cannot hold."""


def document(root: Element) -> bytes:
    """The file: the same tree gives the same bytes."""
    written: bytes = tostring(root, encoding="utf-8", xml_declaration=True, pretty_print=True)
    return written


def sealed_document(root: Element) -> bytes:
    """The file of a tree that is signed as it stands: not a space is added."""
    written: bytes = tostring(root, encoding="utf-8", xml_declaration=True)
    return written
