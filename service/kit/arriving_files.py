"""A file as it comes in, before anything is known of its contents."""

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
"""Contents of an upload: bytes where they are few."""


def where(content: Content) -> bytes | Path:
    """The input for a reader: the bytes, or the path of the file with them."""
    return content.path if isinstance(content, Landed) else content


def held(content: Content) -> bytes:
    """All of its bytes, in memory."""
    return content.path.read_bytes() if isinstance(content, Landed) else content
