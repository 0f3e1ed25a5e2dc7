"""The words of the typesetter's templates: what they give to ``say("…")``."""

import re
from collections.abc import Iterator

from service.languages.message import Message

SAID = re.compile(r"\bsay\(\"([^\"]+)\"")


def messages(source: str, name: str) -> Iterator[Message]:
    """The messages of a template, in order."""
    yield from (Message(text, place=name) for text in SAID.findall(source))
