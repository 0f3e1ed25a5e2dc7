"""Headings, units and values → a first mapping for people to correct."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.json_object import Json
from estimator.reading.bounds import WITHIN
from service.ingest.layout.evidence import Array, clock_unit
from service.ingest.layout.senses import Sense, is_of_another_thing, sense_of, words_of
from service.ingest.layout.triads import FoundSensor, found_in, without_headings
from service.ingest.layout.vocabulary import (
    ASIDE,
    BY_WORD,
    DIRECT,
    ERROR_WORDS,
    FLIPPED,
    LOOK_ALIKE,
    SENSOR_WORDS,
    TIME_WORDS,
    plain_label,
    unit_of,
)

IN_BRACKETS = re.compile(r"^(?P<name>.*?)\s*[\[(](?P<unit>(?:[^\[\]()]|\([^()]*\)){1,24})[\])]\s*$")
BEHIND_BLANK = re.compile(r"^(?P<name>.+?)[_ ](?P<unit>[^\s\[(]{1,12}/[^\s\[(]{1,8}|\S{1,6} [sс]\^?[-−⁻][12¹²])$")
AFTER_COMMA = re.compile(r"^(?P<name>.+?)\s*[,/;:]\s*(?P<unit>[^,;]{1,12})$")
AFTER_BAR = re.compile(r"^(?P<name>.+?)[_ ](?P<unit>[^\W_]{1,5}(?:_s2?)?|°C|°)$")
"""Unit of a heading: in brackets, with a stroke behind a blank, after a comma, after an underscore or a space."""
PLACE = re.compile(r"\s*(?:\d{1,3}|[xyzXYZ])\s*")
"""Content of brackets that is no unit but the place of a sensor."""
NUMBERED = re.compile(r"^(?P<word>\D*?)[ _.\-№#]*(?P<place>\d{1,3}|[xyzXYZ])$")
"""A sensor by its number or axis."""
NO_HEADING = re.compile(r"(?:column \d+)?")
"""Heading of a column in a table without any."""
LABELS = (
    "run", "beta_deg", "position", "turn_angle_deg", "turn_rate_deg_s", "direction_x", "direction_y", "direction_z",
)  # fmt: skip
"""Columns that say how the block stood or was turned: they stay while it rests."""
MOVES = 0.2
"""Share of the rows with another value than the row before from which a quantity of many rows is no label."""
MANY_ROWS = 200
"""Rows from which that shows: a stand has fewer settings."""


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
    values: Array | None = None
    """(n,) first values, NaN where there is none; of dates and times of day their seconds."""


@dataclass(frozen=True)
class Understood:
    """One column as it is proposed."""

    column: Json
    """Column of a mapping."""
    kind: str = ""
    """Kind of a new sensor; else empty."""


def understood(columns: Sequence[SeenColumn], sensors: Sequence[Mapping[str, Any]]) -> list[Json]:
    """Columns of a mapping; ``sensors`` are those of the unit or its type, empty where unknown."""
    return [guess.column for guess in with_kinds(columns, sensors)]


def with_kinds(
    columns: Sequence[SeenColumn], sensors: Sequence[Mapping[str, Any]], table: str = ""
) -> list[Understood]:
    """The same with the kinds of new sensors; ``table``: what the table is called."""
    names = {_plain(str(sensor.get("name", ""))): str(sensor.get("name", "")) for sensor in sensors}
    senses = {k: sense for k, column in enumerate(columns) if (sense := _sense(column)) is not None}
    found: dict[int, FoundSensor | None] = {}
    bare = not names and all(NO_HEADING.fullmatch(column.heading) for column in columns)
    if not names:
        values = {k: column.values for k, column in enumerate(columns) if column.numeric}
        found = without_headings(values) if bare else found_in(senses, values, table)
    guesses: list[Understood] = []
    used: set[str] = set()
    for k, column in enumerate(columns):
        sensor = found.get(k)
        if sensor is not None:
            unit = {"unit": sensor.unit} if sensor.unit else {}
            guess = Understood({"heading": column.heading, "as": sensor.name, **unit}, sensor.kind)
        else:
            guess = Understood(_guess(column, names, senses.get(k), is_none=k in found))
        if bare and "time_s" not in used and not guess.column["as"] and _is_clock(column):
            clock, is_certain = clock_unit(column.values) if column.values is not None else ("", False)
            guess = Understood({"heading": column.heading, "as": "time_s"} | ({"unit": clock} if is_certain else {}))
        if guess.column["as"] in used:
            guess = Understood({"heading": column.heading, "as": None})
        used |= {guess.column["as"]} - {None}
        guesses.append(guess)
    return guesses


def _sense(column: SeenColumn) -> Sense | None:
    """The sensor that a heading names; none of a column of texts, or with a meaning of its own."""
    name, unit = split_unit(column.heading)
    is_named = column.meaning or _plain(name) in (*BY_WORD, *ASIDE) or {*words_of(name)} & {*ERROR_WORDS}
    if column.empty or not column.numeric or is_named:
        return None
    return sense_of(name, unit)


def joined(group: str, heading: str) -> str:
    """A heading under that of a group, whose unit applies where the heading has none."""
    if not group:
        return heading
    name, unit = split_unit(group)
    own_unit = split_unit(heading)[1]
    return f"{name} {heading} [{unit}]" if unit and not own_unit else f"{group} {heading}"


def split_unit(heading: str) -> tuple[str, str]:
    """``β, град`` → ``β`` and ``град``; an empty unit where none is recognised."""
    for pattern in (IN_BRACKETS, BEHIND_BLANK, AFTER_COMMA, AFTER_BAR):
        match = pattern.match(heading.strip())
        if match and unit_of(match["unit"]) is not None:
            return match["name"], plain_label(match["unit"])
    match_any = IN_BRACKETS.match(heading.strip())
    return (match_any["name"], "") if match_any and not PLACE.fullmatch(match_any["unit"]) else (heading, "")


def _guess(column: SeenColumn, names: Mapping[str, str], sense: Sense | None, *, is_none: bool) -> Json:
    """A column that is no new sensor; ``is_none``: its values say that it is no sensor at all."""
    name, unit = split_unit(column.heading)
    guess: Json = {"heading": column.heading, "as": None}
    if column.empty or is_none:
        return guess
    meaning = column.meaning or _meaning(name, unit, column, names, sense)
    if (meaning in LABELS and _moves(column)) or (
        meaning == "time_s" and column.cells and not column.numeric and column.values is None
    ):
        return guess
    if meaning == "temperature_c" and not unit and column.values is not None and not _is_of_a_room(column.values):
        return guess
    if meaning == "time_s":
        unit = unit or _unit_of_time(name, column)
    guess |= {"as": meaning} | ({"unit": unit} if unit and meaning else {})
    if meaning == "run":
        guess["words"] = run_words(column.words)
    if meaning in ("run", "position") and column.holes:
        guess["fill_down"] = True
    return guess


def _is_clock(column: SeenColumn) -> bool:
    """Whether a column without a heading advances as a clock does, and not as numbers of rows do."""
    if column.values is None or not column.numeric or len(column.values) < MANY_ROWS:
        return False
    steps = np.diff(column.values)
    return bool(np.all(steps >= 0) and np.median(steps) > 0 and not np.all(steps == 1))


def _is_of_a_room(values: Array) -> bool:
    """Whether temperatures without a unit may be in °C: counts of a thermometer are not."""
    return bool(WITHIN["temperature_c"].held_by(values[np.isfinite(values)]).all())


def _moves(column: SeenColumn) -> bool:
    """Whether the values of many rows are too often new ones for a setting."""
    values = column.values
    return values is not None and len(values) >= MANY_ROWS and bool(np.mean(np.diff(values) != 0) > MOVES)


def _unit_of_time(name: str, column: SeenColumn) -> str:
    """The unit of times by a word of their heading, or by the times themselves where these leave no doubt."""
    words = [word for word in words_of(name) if getattr(unit_of(word), "quantity", "") == "time" and len(word) > 1]
    if words:
        return plain_label(words[-1])
    if column.values is None or not column.numeric:
        return ""
    unit, is_certain = clock_unit(column.values)
    return unit if is_certain else ""


def _meaning(name: str, unit: str, column: SeenColumn, names: Mapping[str, str], sense: Sense | None) -> str | None:
    """A column of a session, a sensor, a sensor's standard error, or None."""
    plain, quantity = _plain(name), getattr(unit_of(unit), "quantity", "") if unit else ""
    words = words_of(name)
    if plain in names:
        return names[plain]
    if quantity == "temperature" or (not quantity and any(word.startswith(("temp", "темп")) for word in words)):
        return "time_s" if "temps" in words else "temperature_c"
    if column.words and all(_run_word(word) in (*DIRECT, *FLIPPED) for word in column.words) and not column.numeric:
        return "run"
    whole = _plain(column.heading)
    if whole in BY_WORD or plain in BY_WORD:
        return BY_WORD.get(whole) or BY_WORD[plain]
    if quantity == "time" or (not quantity and any(word in TIME_WORDS for word in words) and sense is None):
        return "time_s"
    for word in ERROR_WORDS:
        rest = plain.removesuffix(word) if plain.endswith(word) else plain.removeprefix(word)
        if rest != plain and (sensor := _sensor(_plain(rest), names)):
            return f"{sensor}_se"
    if plain in ASIDE or not column.numeric:
        return next((BY_WORD[w] for w in map(_plain, re.split(r"[\s,]+", name)) if w in BY_WORD), None)
    if sense is not None and (sensor := _known(sense.letter, sense.place, names)):
        return sensor
    if is_of_another_thing(name) and not _by_a_word(name):
        return None
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
    return _known(letter, place, names) or (None if names else f"{letter or 'A'}{place}")


def _known(letter: str, place: str, names: Mapping[str, str]) -> str | None:
    """The known sensor of this letter and place, or the only one at this place."""
    if place and f"{letter}{place}".casefold() in names:
        return names[f"{letter}{place}".casefold()]
    candidates = [sensor for short, sensor in names.items() if place and short.endswith(place.casefold())]
    return candidates[0] if len(candidates) == 1 and (not letter or candidates[0][0] == letter) else None


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
