"""A message of a template, put together from its flat text: places for expressions, tags without attributes."""

import re
from dataclasses import dataclass, field

from service.languages.entry import COUNT, MessageEntry

NAME = re.compile(r"[A-Za-z_]\w*")
QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'")
FILTER = re.compile(r"\|[\w\s(),.'\"]*$")
ONE_OR_MANY = re.compile(r"""\{\{\s*(?:""|'')\s*if\s+(.+?)\s*==\s*1\s+else\s+["'](\w+)["']\s*\}\}""")
"""Pattern of a template's ending of a word that depends on a number."""
TOO_COMMON = frozenset(("page", "loop", "if", "else", "or", "and", "not", "length", "none", "in", "is"))
"""Names that tell a translator nothing."""


@dataclass
class Piece:
    """Message under construction: the text of one and of many, the expressions in its places, and the counted one."""

    one: str = ""
    many: str = ""
    sources: dict[str, str] = field(default_factory=dict)
    kinds: dict[str, str] = field(default_factory=dict)
    """The tag of every inline element, by its name in the message."""
    counted: str = ""

    def add(self, text: str) -> None:
        """Words."""
        self.one, self.many = self.one + text, self.many + text

    def put(self, source: str, name: str) -> None:
        """A place for a value."""
        self.add(f"{{{self._named(source, name)}}}")

    def tag(self, source: str, kind: str) -> str:
        """The beginning of an inline element; returns its name in the message."""
        name = self._named(source, kind)
        self.kinds[name] = kind
        self.add(f"<{name}>")
        return name

    def _named(self, source: str, name: str) -> str:
        free, k = name, 1
        while free in self.sources and self.sources[free] != source:
            k += 1
            free = f"{name}{k}"
        self.sources[free] = source
        return free

    def expression(self, source: str) -> None:
        """A place for a value; an ending after a number makes a plural of the message."""
        ending = ONE_OR_MANY.fullmatch(source)
        if ending is None:
            self.put(source, name_of(source))
            return
        self.many += ending[2]
        self.counted = ending[1]

    def message(self, file: str) -> MessageEntry:
        """The message as in a catalogue: spaces and line ends are one space."""
        singular, plural = " ".join(self.one.split()), " ".join(self.many.split())
        if not self.counted:
            return MessageEntry(singular, place=file)
        number = next((n for n, s in self.sources.items() if s.strip("{} ") == self.counted), "")
        if number:
            singular, plural = (text.replace(f"{{{number}}}", f"{{{COUNT}}}") for text in (singular, plural))
            self.sources[COUNT] = self.sources.pop(number)
        return MessageEntry(singular, plural, file)


def name_of(expression: str) -> str:
    """The name of an expression for translators: the last telling name in it."""
    inner = FILTER.sub("", QUOTED.sub("", expression.strip("{} ")))
    called = re.match(r"\w+(?=\()", inner)
    if called:
        return called.group()
    names = [name for name in NAME.findall(inner.split(" if ")[0]) if name not in TOO_COMMON]
    return names[-1].lower() if names else "value"
