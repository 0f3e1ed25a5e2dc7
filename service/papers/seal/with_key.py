"""The seal of a key."""

from functools import partial
from pathlib import Path

from service.papers.seal.keys import read_key, require_valid
from service.papers.seal.pdf import sealed_pdf
from service.papers.seal.xml import sealed_xml
from service.papers.sealing import Seal


def seal_with(key_file: Path, password_file: Path | None) -> Seal:
    """The seal of a key; ServiceError where it cannot be used."""
    pair = read_key(key_file, password_file)
    return Seal(pair.subject, partial(require_valid, pair), partial(sealed_pdf, pair), partial(sealed_xml, pair))
