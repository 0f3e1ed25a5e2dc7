"""What people say of a session or a unit: remarks, and files that they attached."""

from collections.abc import Sequence
from dataclasses import dataclass

from service.measures import size_in_words
from service.records.event import Attachment, Note


@dataclass(frozen=True)
class AttachmentLine:
    """One attached file."""

    attachment: Attachment
    size: str

    @property
    def digest(self) -> str:
        """The head of its hash."""
        return self.attachment.sha256[:12]


@dataclass(frozen=True)
class Remarks:
    """All that was said of one record."""

    unit: str
    session: str
    """Empty for the unit as a whole."""
    notes: tuple[Note, ...]
    files: tuple[AttachmentLine, ...]
    limit: str
    """How large a file may be, in words."""


def remarks(unit: str, session: str, notes: Sequence[Note], files: Sequence[Attachment], most_bytes: int) -> Remarks:
    """Oldest first, as they were said."""
    lines = tuple(AttachmentLine(one, size_in_words(one.size)) for one in files)
    return Remarks(unit, session, tuple(notes), lines, size_in_words(most_bytes))
