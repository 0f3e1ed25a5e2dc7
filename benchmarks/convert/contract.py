"""What a converter is: a public format of raw recordings → session files, with nothing judged on the way."""

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
    """What the recording is, in one sentence."""
    files: str
    """Which files to name on the command line."""
    convert: Callable[[list[Path]], list[tuple[str, Document]]]
    """Files → suggested file name (without folder) and session, one or more."""
