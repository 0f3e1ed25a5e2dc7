"""Headings and first cells → a first mapping, for people to correct: a guess that says where it comes from."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from estimator.json_object import Json
from service.ingest.layout.vocabulary import (
    ASIDE,
    BY_WORD,
    DIRECT,
    ERROR_WORDS,
    FLIPPED,
    LOOK_ALIKE,
    SENSOR_WORDS,
    plain_label,
    unit_of,
)

IN_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>[^\[\]()]{1,20})[\])]\s*$")
AFTER_COMMA = re.compile(r"^(?P<name>.+?)\s*[,/;:]\s*(?P<unit>[^,;]{1,12})$")
AFTER_BAR = re.compile(r"^(?P<name>.+?)[_ ](?P<unit>[^\W_]{1,5}(?:_s2?)?|°C|°)$")
"""Where a heading states its unit: in brackets, after a comma, after an underscore or a space."""
NUMBERED = re.compile(r"^(?P<word>\D*?)[ _.\-№#]*(?P<place>\d{1,3}|[xyzXYZ])$")
"""A sensor by its number or axis."""


@dataclass(frozen=True)
class Seen:
    """One column as it stands in the file."""

    heading: str
    cells: Sequence[str]
    """Its first ones, as text."""
    numeric: bool
    """Whether most of all its cells are numbers."""
    empty: bool
    words: Sequence[str] = ()
    """The different texts of a column with few of them."""
    holes: bool = False
    """Whether cells are empty below filled ones."""
    meaning: str | None = None
    """What the file itself says that it is."""


def understood(columns: Sequence[Seen], sensors: Sequence[Mapping[str, Any]]) -> list[Json]:
    """A mapping's columns; ``sensors`` are those of the unit or its type, none where nothing is known of it."""
    names = {_plain(str(sensor.get("name", ""))): str(sensor.get("name", "")) for sensor in sensors}
    found: list[Json] = []
    taken: set[str] = set()
    for column in columns:
        guess = _guess(column, names)
        if guess["as"] in taken:
            guess = {**guess, "as": None}
        taken |= {guess["as"]} - {None}
        found.append(guess)
    return found


def joined(group: str, heading: str) -> str:
    """A heading under that of a group, whose unit is its own where it states none."""
    if not group:
        return heading
    plain, unit = split_unit(group)
    own = split_unit(heading)[1]
    return f"{plain} {heading} [{unit}]" if unit and not own else f"{group} {heading}"


def split_unit(heading: str) -> tuple[str, str]:
    """``β, град`` → ``β`` and ``град``; no unit where none is known."""
    for pattern in (IN_BRACKETS, AFTER_COMMA, AFTER_BAR):
        match = pattern.match(heading.strip())
        if match and unit_of(match["unit"]) is not None:
            return match["name"], plain_label(match["unit"])
    bare = IN_BRACKETS.match(heading.strip())
    return (bare["name"], "") if bare else (heading, "")


def _guess(column: Seen, names: Mapping[str, str]) -> Json:
    name, unit = split_unit(column.heading)
    guess: Json = {"heading": column.heading, "as": None}
    if column.empty:
        return guess
    meaning = column.meaning or _meaning(name, unit, column, names)
    guess |= {"as": meaning} | ({"unit": unit} if unit and meaning else {})
    if meaning == "run":
        guess["words"] = run_words(column.words)
    if meaning in ("run", "position") and column.holes:
        guess["fill_down"] = True
    return guess


def _meaning(name: str, unit: str, column: Seen, names: Mapping[str, str]) -> str | None:
    """A column of a session, a sensor, a sensor's standard error, or nothing."""
    plain, quantity = _plain(name), getattr(unit_of(unit), "quantity", "") if unit else ""
    if quantity == "temperature" and plain in ("t", "т", "temp", "температура"):
        return "temperature_c"
    if plain in names:
        return names[plain]
    whole = _plain(column.heading)
    if whole in BY_WORD or plain in BY_WORD:
        return BY_WORD.get(whole) or BY_WORD[plain]
    for word in ERROR_WORDS:
        rest = plain.removesuffix(word) if plain.endswith(word) else plain.removeprefix(word)
        if rest != plain and (sensor := _sensor(_plain(rest), name, names)):
            return f"{sensor}_se"
    if plain in ASIDE or not column.numeric:
        return next((BY_WORD[w] for w in map(_plain, re.split(r"[\s,]+", name)) if w in BY_WORD), None)
    return _sensor(plain, name, names) or _by_its_end(name, names) or _by_a_word(name)


def _by_its_end(name: str, names: Mapping[str, str]) -> str | None:
    """A sensor at the end of a longer heading: *Readings Channel 1*."""
    words = name.split()
    ends = (_plain(" ".join(words[k:])) for k in range(1, len(words)))
    return next((sensor for end in ends if (sensor := _sensor(end, name, names))), None)


def _by_a_word(name: str) -> str | None:
    """By any word of a longer heading: *Angle of the head*."""
    return next((BY_WORD[word] for word in map(_plain, re.split(r"[\s,_]+", name)) if word in BY_WORD), None)


def _sensor(plain: str, name: str, names: Mapping[str, str]) -> str | None:
    """The sensor of a number or axis: one that is known, or else its plain name."""
    if plain in names:
        return names[plain]
    match = NUMBERED.match(plain)
    if match is None or match["word"] not in SENSOR_WORDS:
        return None
    letter, place = SENSOR_WORDS[match["word"]], match["place"].lstrip("0").upper()
    known = [full for short, full in names.items() if short.endswith(place.casefold())]
    if len(known) == 1 or (letter and f"{letter}{place}" in known):
        return known[0] if len(known) == 1 else f"{letter}{place}"
    return None if names else f"{letter or 'A'}{place}"


def run_words(words: Sequence[str]) -> dict[str, str]:
    """What the run's words mean; of two unknown ones the first is taken for the direct run."""
    found = {}
    for word in words:
        plain = word.strip().casefold().replace("ё", "е")
        found[word] = "direct" if plain in DIRECT else "flipped" if plain in FLIPPED else ""
    rest = [word for word, meaning in found.items() if not meaning]
    free = [run for run in ("direct", "flipped") if run not in found.values()]
    return found | dict(zip(rest, free, strict=False)) if len(rest) <= len(free) else found


def _plain(text: str) -> str:
    """In small letters, without spaces and marks; Cyrillic letters of a sensor's name as their Latin twins."""
    squeezed = re.sub(r"[\s_.\-:]+", "", text.strip())
    if re.fullmatch(r"[АВСЕНКМОРТХавсеорху]\d{1,3}", squeezed):
        squeezed = squeezed.upper().translate(LOOK_ALIKE)
    return squeezed.casefold().replace("ё", "е")
