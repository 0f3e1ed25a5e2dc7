"""The laboratory's electronic seal, where the operator has set a key: files that any checker of signatures can check.

The libraries that it needs come with ``pip install 'imu-health[sign]'`` and are imported when a key is set.
"""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import datetime
from importlib import import_module
from pathlib import Path
from types import ModuleType

from service.errors import ServiceError

ROOM = "service.papers.seal"
WITHOUT = "A key for the electronic seal is set, but a library is missing: {fault}. Run pip install 'imu-health[sign]'."


@dataclass(frozen=True)
class Seal:
    """The laboratory's seal."""

    subject: str
    """Subject of its certificate."""
    require_valid: Callable[[datetime], None]
    """ConflictError outside of the time for which the certificate was made."""
    pdf: Callable[[bytes], bytes]
    """The PDF with a signature that allows no change (PAdES B-B)."""
    xml: Callable[[bytes], bytes]
    """The XML with an enveloped signature (XAdES-B)."""


def seal_room(part: str) -> ModuleType:
    """A part that needs further libraries; ServiceError in words where they are not installed."""
    try:
        return import_module(f"{ROOM}.{part}")
    except ModuleNotFoundError as fault:
        raise ServiceError(WITHOUT, fault=fault) from fault


def seal_of(key_file: Path | None, password_file: Path | None) -> Seal | None:
    """The seal of a key; None where none is set, ServiceError where it cannot be used."""
    if key_file is None:
        return None
    found: Seal = seal_room("with_key").seal_with(key_file, password_file)
    return found
