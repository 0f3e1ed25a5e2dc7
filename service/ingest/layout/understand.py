"""Headings and first cells → a first mapping for people to correct."""

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
"""Unit of a heading: in brackets, after a comma, after an underscore or a space."""
NUMBERED = re.compile(r"^(?P<word>\D*?)[ _.\-№#]*(?P<place>\d{1,3}|[xyzXYZ])$")
"""A sensor by its number or axis."""


@dataclass(frozen=True)
class SeenColumn:
    """One column as in the file."""

    heading: str
    cells: Sequence[str]
    """First cells, as text."""
    numeric: bool
    """Whether most of its cells are numbers."""
    empty: bool
    words: Sequence[str] = ()
    """Distinct texts of a column with few of them."""
    holes: bool = False
    """Whether cells are empty below filled ones."""
    meaning: str | None = None
    """Meaning stated in the file."""


def understood(columns: Sequence[SeenColumn], sensors: Sequence[Mapping[str, Any]]) -> list[Json]:
    """Columns of a mapping; ``sensors`` are those of the unit or its type, empty where unknown."""
    names = {_plain(str(sensor.get("name", ""))): str(sensor.get("name", "")) for sensor in sensors}
    guesses: list[Json] = []
    used: set[str] = set()
    for column in columns:
        guess = _guess(column, names)
        if guess["as"] in used:
            guess = {**guess, "as": None}
        used |= {guess["as"]} - {None}
        guesses.append(guess)
    return guesses


def joined(group: str, heading: str) -> str:
    """A heading under that of a group, whose unit applies where the heading has none."""
    if not group:
        return heading
    name, unit = split_unit(group)
    own_unit = split_unit(heading)[1]
    return f"{name} {heading} [{unit}]" if unit and not own_unit else f"{group} {heading}"


def split_unit(heading: str) -> tuple[str, str]:
    """``β, град`` → ``β`` and ``град``; an empty unit where none is recognised."""
    for pattern in (IN_BRACKETS, AFTER_COMMA, AFTER_BAR):
        match = pattern.match(heading.strip())
        if match and unit_of(match["unit"]) is not None:
            return match["name"], plain_label(match["unit"])
    match_any = IN_BRACKETS.match(heading.strip())
    return (match_any["name"], "") if match_any else (heading, "")


def _guess(column: SeenColumn, names: Mapping[str, str]) -> Json:
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


def _meaning(name: str, unit: str, column: SeenColumn, names: Mapping[str, str]) -> str | None:
    """A column of a session, a sensor, a sensor's standard error, or None."""
    plain, quantity = _plain(name), getattr(unit_of(unit), "quantity", "") if unit else ""
    if quantity == "temperature" and plain in ("t", "т", "temp", "температура"):
        return "temperature_c"
    if plain in names:
        return names[plain]
    if column.words and all(_run_word(word) in (*DIRECT, *FLIPPED) for word in column.words) and not column.numeric:
        return "run"
    whole = _plain(column.heading)
    if whole in BY_WORD or plain in BY_WORD:
        return BY_WORD.get(whole) or BY_WORD[plain]
    for word in ERROR_WORDS:
        rest = plain.removesuffix(word) if plain.endswith(word) else plain.removeprefix(word)
        if rest != plain and (sensor := _sensor(_plain(rest), names)):
            return f"{sensor}_se"
    if plain in ASIDE or not column.numeric:
        return next((BY_WORD[w] for w in map(_plain, re.split(r"[\s,]+", name)) if w in BY_WORD), None)
    return _sensor(plain, names) or _by_its_end(name, names) or _by_a_word(name)


def _by_its_end(name: str, names: Mapping[str, str]) -> str | None:
    """A sensor at the end of a longer heading: *Readings Channel 1*."""
    words = name.split()
    ends = (_plain(" ".join(words[k:])) for k in range(1, len(words)))
    return next((sensor for end in ends if (sensor := _sensor(end, names))), None)


def _by_a_word(name: str) -> str | None:
    """The meaning by any word of a longer heading: *Angle of the head*."""
    return next((BY_WORD[word] for word in map(_plain, re.split(r"[\s,_]+", name)) if word in BY_WORD), None)


def _sensor(plain: str, names: Mapping[str, str]) -> str | None:
    """The sensor of a number or axis: a known one, or else its plain name."""
    if plain in names:
        return names[plain]
    match = NUMBERED.match(plain)
    if match is None or match["word"] not in SENSOR_WORDS:
        return None
    letter, place = SENSOR_WORDS[match["word"]], match["place"].lstrip("0").upper()
    candidates = [sensor for short, sensor in names.items() if short.endswith(place.casefold())]
    if len(candidates) == 1 or (letter and f"{letter}{place}" in candidates):
        return candidates[0] if len(candidates) == 1 else f"{letter}{place}"
    return None if names else f"{letter or 'A'}{place}"


def run_words(words: Sequence[str]) -> dict[str, str]:
    """Meanings of the run's words; the first of two unknown words is taken for the direct run."""
    meanings = {}
    for word in words:
        plain = _run_word(word)
        meanings[word] = "direct" if plain in DIRECT else "flipped" if plain in FLIPPED else ""
    unknown = [word for word, meaning in meanings.items() if not meaning]
    unused = [run for run in ("direct", "flipped") if run not in meanings.values()]
    return meanings | dict(zip(unknown, unused, strict=False)) if len(unknown) <= len(unused) else meanings


def _run_word(word: str) -> str:
    return word.strip().casefold().replace("ё", "е")


def _plain(text: str) -> str:
    """The text in lower case, without spaces and punctuation; Cyrillic letters of a sensor's name as their Latin
    twins.
    """
    compact = re.sub(r"[\s_.\-:]+", "", text.strip())
    if re.fullmatch(r"[АВСЕНКМОРТХавсеорху]\d{1,3}", compact):
        compact = compact.upper().translate(LOOK_ALIKE)
    return compact.casefold().replace("ё", "е")
