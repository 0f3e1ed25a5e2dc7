"""Electronic seals: PAdES on PDF, XAdES on XML, with the laboratory's key."""

from functools import partial
from pathlib import Path

from service.papers.seal.keys import KeyPair, read_key, require_valid
from service.papers.seal.pdf import sealed_pdf
from service.papers.seal.trial import make_trial_key
from service.papers.seal.xml import owner_of_seal, sealed_xml
from service.papers.sealing import Seal

__all__ = ["KeyPair", "make_trial_key", "owner_of_seal", "read_key", "seal_with"]


def seal_with(key_file: Path, password_file: Path | None) -> Seal:
    """The seal of a key; ServiceError where it cannot be used."""
    pair = read_key(key_file, password_file)
    return Seal(pair.subject, partial(require_valid, pair), partial(sealed_pdf, pair), partial(sealed_xml, pair))
