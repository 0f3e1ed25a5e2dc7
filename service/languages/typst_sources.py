"""The messages of the typesetter's templates: the arguments of ``say("…")``."""

import re
from collections.abc import Iterator

from service.languages.entry import MessageEntry

SAY_CALL = re.compile(r"\bsay\(\"([^\"]+)\"")


def messages(source: str, name: str) -> Iterator[MessageEntry]:
    """The messages of a template, in order."""
    yield from (MessageEntry(text, place=name) for text in SAY_CALL.findall(source))
