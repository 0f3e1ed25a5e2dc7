"""Sentences with their parts: English for whoever takes them as text, any language for whoever knows its words.

A message is made once, where the fact is known. It keeps the English template and what stands in its places, which may
be messages again; so nobody has to take a finished sentence apart. It is a string, its English text.
"""

import re
from collections.abc import Callable, Iterable, Mapping
from functools import reduce
from types import MappingProxyType
from typing import Any

from estimator.json_object import Json

PLACE = re.compile(r"\{(\w+)\}")
"""Place of a part in a template."""
PLACES = re.compile(r"(\{\w+\})")
MARK = "message"
KEYS = frozenset((MARK, "parts", "many", "number"))
"""Keys under which JSON keeps a message."""
NO_PARTS: Mapping[str, str] = MappingProxyType({})


class Message(str):
    """An English sentence that knows what it was made of.

    template : with ``{places}``; of a counted thing, what is said of one.
    parts : what stands in the places: messages, words, names and numbers as they are shown.
    many : what is said of several; empty where nothing is counted.
    number : the number that decides between the two.
    """

    __slots__ = ("many", "number", "parts", "template")
    template: str
    parts: Mapping[str, str]
    many: str
    number: int | None

    def __new__(
        cls, template: str, parts: Mapping[str, str] = NO_PARTS, many: str = "", number: int | None = None
    ) -> "Message":
        self = super().__new__(cls, filled(template if number in (None, 1) else many, parts))
        self.template, self.parts, self.many, self.number = template, parts, many, number
        return self

    def __str__(self) -> str:
        """Itself: what is made from an error keeps the parts of its sentence."""
        return self

    def __add__(self, other: str) -> "Message":
        return joined("", (self, other))

    def __radd__(self, other: str) -> "Message":
        return joined("", (other, self))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickles the message for copies and for other processes."""
        return Message, (self.template, dict(self.parts), self.many, self.number)


def say(template: str, /, **parts: object) -> Message:
    """The sentence of a template with its parts; what is no text stands as Python writes it."""
    return Message(template, _texts(parts))


def say_count(singular: str, plural: str, number: int, /, **parts: object) -> Message:
    """A sentence about a number of things, which stands in the place ``{n}``."""
    return Message(singular, {"n": str(number)} | _texts(parts), plural, number)


def joined(joint: str, parts: Iterable[str]) -> Message:
    """Texts in a row with a joint between them, ``"; "`` or ``" and "``."""
    listed = tuple(parts)
    if any(map(str.isalpha, joint)) and listed:
        return reduce(
            lambda first, last: say(f"{{first}}{joint}{{last}}", first=first, last=last),
            listed[1:],
            say("{p0}", p0=listed[0]),
        )
    return say(joint.join(f"{{p{k}}}" for k in range(len(listed))), **{f"p{k}": part for k, part in enumerate(listed)})


def capitalised(text: str) -> str:
    """The text with a capital first letter."""
    return _begun(text, str.upper)


def uncapitalised(text: str) -> str:
    """The text with a small first letter."""
    return _begun(text, str.lower)


def without_stop(text: str) -> str:
    """The text without its full stop."""
    if not isinstance(text, Message):
        return text.removesuffix(".")
    if last := re.search(r"\{(\w+)\}$", text.template):
        return _with_part(text, last[1], without_stop)
    return Message(text.template.removesuffix("."), text.parts, text.many.removesuffix("."), text.number)


def changed(text: str, change: Callable[[str], str]) -> str:
    """The text with ``change`` applied to every text that it is made of."""
    if not isinstance(text, Message):
        return change(text)
    parts = {name: changed(part, change) for name, part in text.parts.items()}
    return Message(_between(text.template, change), parts, _between(text.many, change), text.number)


def filled(template: str, parts: Mapping[str, str]) -> str:
    """A template with its parts in their places."""
    return PLACE.sub(lambda place: parts.get(place[1], place[0]), template)


def as_document(message: Message) -> Json:
    """A message as JSON keeps it with its parts."""
    parts = {name: as_document(part) if isinstance(part, Message) else part for name, part in message.parts.items()}
    document: Json = {MARK: message.template} | ({"parts": parts} if parts else {})
    return document if message.number is None else document | {"many": message.many, "number": message.number}


def with_messages(document: Any) -> Any:
    """JSON with every message that `as_document` wrote in its place; what earlier releases wrote is plain text."""
    match document:
        case {"message": str(template)} if document.keys() <= KEYS:
            return Message(
                template, with_messages(document.get("parts", {})), document.get("many", ""), document.get("number")
            )
        case dict():
            return {key: with_messages(value) for key, value in document.items()}
        case list():
            return [with_messages(value) for value in document]
        case _:
            return document


def _texts(parts: Mapping[str, object]) -> dict[str, str]:
    return {name: part if isinstance(part, str) else str(part) for name, part in parts.items()}


def _begun(text: str, change: Callable[[str], str]) -> str:
    """The text with another first letter."""
    if not isinstance(text, Message):
        return change(text[:1]) + text[1:]
    if first := PLACE.match(text.template):
        return _with_part(text, first[1], lambda part: _begun(part, change))
    singular, plural = (change(form[:1]) + form[1:] for form in (text.template, text.many))
    return Message(singular, text.parts, plural, text.number)


def _between(template: str, change: Callable[[str], str]) -> str:
    """A template with what stands between its places changed."""
    pieces = PLACES.split(template)
    return "".join(piece if PLACES.fullmatch(piece) else change(piece) for piece in pieces)


def _with_part(message: Message, name: str, change: Callable[[str], str]) -> Message:
    parts = dict(message.parts) | {name: change(message.parts[name])}
    return Message(message.template, parts, message.many, message.number)
