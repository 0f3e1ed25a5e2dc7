"""A file as it comes in, before anything is known of what it holds."""

from dataclasses import dataclass
from pathlib import Path

DEMONSTRATION = "demonstration"
"""Signs every upload of the demonstration fleet."""


@dataclass(frozen=True)
class Landed:
    """The bytes of a long upload, in a file of its own."""

    path: Path
    sha256: str
    size: int

    def __len__(self) -> int:
        return self.size


Content = bytes | Landed
"""Of an upload: bytes where they are few."""


def where(content: Content) -> bytes | Path:
    """What reads it is given: the bytes, or where they lie."""
    return content.path if isinstance(content, Landed) else content


def held(content: Content) -> bytes:
    """All of its bytes, in memory."""
    return content.path.read_bytes() if isinstance(content, Landed) else content
