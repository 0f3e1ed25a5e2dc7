"""The languages of the service, and the choice among them."""

from collections.abc import Iterator, Mapping, MutableMapping
from enum import Enum
from http.cookies import CookieError, SimpleCookie
from typing import Any
from urllib.parse import parse_qs

COOKIE = "language"
QUERY = "lang"
"""Name of what chooses a language by hand: ``?lang=ru``."""
YEAR = 365 * 24 * 3600
"""Seconds that a choice by hand is kept."""


class Language(Enum):
    """A language; English is what everything is written in."""

    ENGLISH = "en"
    RUSSIAN = "ru"

    @property
    def name_of_itself(self) -> str:
        """Name of the language in itself."""
        return {Language.ENGLISH: "English", Language.RUSSIAN: "Русский"}[self]


def named(tag: str) -> Language | None:
    """The language of a tag, ``ru`` or ``ru-RU``."""
    return next((language for language in Language if language.value == tag.strip().lower().split("-")[0]), None)


def chosen_by_query(query: str) -> Language | None:
    """The language that the address names."""
    return named(parse_qs(query).get(QUERY, [""])[-1])


def chosen_before(cookies: str) -> Language | None:
    """The language chosen by hand before, from the request's cookies."""
    try:
        kept = SimpleCookie(cookies).get(COOKIE)
    except CookieError:
        return None
    return named(kept.value) if kept else None


def asked(scope: MutableMapping[str, Any]) -> Language:
    """The language of the answer to a request (ASGI): by its address, as chosen before, or as the browser prefers."""
    headers = {name: value.decode("latin-1") for name, value in scope["headers"]}
    return (
        chosen_by_query(scope.get("query_string", b"").decode("latin-1"))
        or chosen_before(headers.get(b"cookie", ""))
        or preferred(headers.get(b"accept-language", ""))
    )


def of_environment(variables: Mapping[str, str]) -> Language:
    """The language of a process, by the variables that gettext programs go by, in their order."""
    names = ("LANGUAGE", "LC_ALL", "LC_MESSAGES", "LANG")
    stated = next((variables[name] for name in names if variables.get(name)), "")
    return next((known for tag in stated.split(":") if (known := named(tag.split("_")[0]))), Language.ENGLISH)


def preferred(header: str) -> Language:
    """The first language of the service in Accept-Language, by its weights (RFC 9110, 12.5.4); English where none
    is.
    """
    for tag in _by_weight(header):
        if tag == "*":
            return Language.ENGLISH
        if known := named(tag):
            return known
    return Language.ENGLISH


def _by_weight(header: str) -> Iterator[str]:
    weighted = [(tag.strip(), _weight(rest)) for tag, _, rest in (part.partition(";") for part in header.split(","))]
    yield from (tag for tag, weight in sorted(weighted, key=lambda pair: -pair[1]) if tag and weight > 0)


def _weight(parameter: str) -> float:
    name, _, value = parameter.partition("=")
    if name.strip().lower() != "q":
        return 1.0
    try:
        return min(1.0, max(0.0, float(value)))
    except ValueError:
        return 0.0
