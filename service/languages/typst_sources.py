"""The words of the typesetter's templates: what they give to ``say("…")``."""

import re
from collections.abc import Iterator

from service.languages.entry import Entry

SAID = re.compile(r"\bsay\(\"([^\"]+)\"")


def messages(source: str, name: str) -> Iterator[Entry]:
    """The messages of a template, in order."""
    yield from (Entry(text, place=name) for text in SAID.findall(source))
