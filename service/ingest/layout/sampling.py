"""A long text → its first rows, and rows from all over it: what a column is, is seen from these."""

from collections.abc import Iterator
from dataclasses import dataclass

from service.ingest.layout.decoding import encoding_of
from service.ingest.layout.envelope import StoredTable

HEAD = 2 * 1024 * 1024
"""Bytes of a text that are read to understand it; a shorter one is read whole."""
FEWEST = 1000
"""Lines of that beginning: with fewer they are too long for a sample."""
FIRST = 256 * 1024
"""Bytes in which the headings stand, and enough rows below them."""
PLACES, PART = 15, 32 * 1024
"""Later places that are looked at, the end among them, and bytes of each."""
COUNTED = 8 * 1024 * 1024
"""Bytes in which lines are counted at a time."""


@dataclass(frozen=True)
class Sample:
    """Whole lines of a text."""

    head: bytes
    later: bytes
    lines: int
    """Lines of the whole text."""

    @property
    def first(self) -> bytes:
        """The headings, and enough rows below them."""
        return self.head if b"\0" in self.head[:FIRST] else self.head[: self.head.rfind(b"\n", 0, FIRST) + 1]


def sample_of(table: StoredTable) -> Sample | None:
    """The sample of a long text; None of one that is to be read whole: it is short, or has few lines."""
    if table.size <= HEAD:
        return None
    start = table.read(0, HEAD)
    encoding = encoding_of(start[: start.rfind(b"\n") + 1])
    if "16" in encoding:  # code units of two bytes: only the beginning is cut between lines
        end = len(
            start[: len(start) // 2 * 2].decode(encoding, "ignore").rpartition("\n")[0].encode(encoding, "ignore")
        )
        head, later = start[:end], b""
    else:
        head = start[: start.rfind(b"\n") + 1]
        step = (table.size - HEAD - PART) // (PLACES - 1)
        parts = (table.read(HEAD + k * step, PART) for k in range(PLACES)) if step > PART else ()
        later = b"".join(part[part.find(b"\n") + 1 : part.rfind(b"\n") + 1] for part in parts)
    if head.count(b"\n") < FEWEST:
        return None
    return Sample(head, later, sum(part.count(b"\n") for part in _parts(table)))


def _parts(table: StoredTable) -> Iterator[bytes]:
    return (table.read(at, COUNTED) for at in range(0, table.size, COUNTED))
