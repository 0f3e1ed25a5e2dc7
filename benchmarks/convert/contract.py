"""The interface of a converter: from a public format of raw recordings to session files, without judging anything."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

Document = dict[str, Any]
"""One session as imu-session/1."""


@dataclass(frozen=True)
class Converter:
    """One public format. ``convert`` raises a `SessionError` that names the file and the place in it."""

    name: str
    description: str
    """The recording in one sentence."""
    files: str
    """Files to name on the command line."""
    convert: Callable[[list[Path]], list[tuple[str, Document]]]
    """Files → suggested file name (without folder) and session, one or more."""
