"""A session file to fill in: a workbook that can be uploaded as it is, with units, choices and an example.

Sheet `session` has the known facts of the block, and yellow cells for the others; sheet `readings` has the schedule and
empty cells for the readings; sheet `example` shows both filled in. Headings and keys are locked, without a password,
against accidental changes.
"""

import io
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import Any

import xlsxwriter
from xlsxwriter.format import Format
from xlsxwriter.worksheet import Worksheet

from estimator.json_object import Json
from estimator.message import say
from estimator.session import ACCELEROMETER, COUNTERS, GYROSCOPE, PROGRAMMES, STAGES, CalibrationSession
from estimator.writing import session_document
from service.ingest.in_russian import SHEETS, heading_in_russian, key_in_russian, value_in_russian
from service.ingest.session_keys import COLUMN_HINTS, KEY_HINTS, NEEDED_HERE, reading_hint, standard_error_hint
from service.languages.catalogue import catalogue_of
from service.languages.language import Language
from service.papers.sheets import OPTIONS, naive, write_text


@dataclass(frozen=True)
class Wording:
    """Words of each part of the workbook."""

    sheet: Callable[[str], str]
    key: Callable[[str], str]
    heading: Callable[[str], str]
    value: Callable[[str, Any], Any]
    """Value of a key or a column, by its English name."""
    say: Callable[[str], str]
    """A hint or a warning."""


def wording(language: Language, sensors: Sequence[str]) -> Wording:
    """The words of a language."""
    if language is Language.ENGLISH:
        return Wording(_unchanged, _unchanged, _unchanged, lambda _, value: value, _unchanged)
    return Wording(
        sheet=lambda name: SHEETS[name],
        key=key_in_russian,
        heading=lambda name: heading_in_russian(name, sensors),
        value=value_in_russian,
        say=catalogue_of(language).say,
    )


def _unchanged(text: str) -> str:
    return text


FILLED_IN = ("unit", "started_at", "powered_on_at", "stage", "operator", "notes")
"""Fields that differ from session to session, in the order of the sheet."""
NOT_COPIED = ("table", "origin", "time_since_power_on_s", *FILLED_IN)
"""Fields of the pattern that say nothing of the next session."""
MEASURED = ("time_s", "temperature_c", "vibration_m_s2", "tilt_se_deg")
"""Columns that are measured with the readings, and not planned."""
CHOICES = {
    "block": (ACCELEROMETER, GYROSCOPE), "kind": (ACCELEROMETER, GYROSCOPE), "programme": PROGRAMMES,
    "stage": STAGES, "counter": COUNTERS, "run": ("direct", "flipped"),
}  # fmt: skip
"""Allowed values of a cell or a column."""
LIMITS = {
    "beta_deg": (-720, 720), "time_s": (0, 1e9), "temperature_c": (-100, 200), "latitude_deg": (-90, 90),
    "height_m": (-500, 9000), "gravity_m_s2": (9.7, 9.9), "alpha_deg": (-90, 90), "chi_deg": (-90, 90),
}  # fmt: skip
"""Limits of numbers, as in the reader."""
MOST_PLANNED = 500
"""Rows of a schedule that are included; not of a log."""
ROOM = 1000
"""Rows with choices and limits: more than any session of positions."""
MOST_SHOWN = 100
"""Rows of the example: a session of positions, or the beginning of a log."""
EXAMPLE = {
    "unit": "BA-017", "started_at": "2026-03-01T09:00:00Z", "powered_on_at": "2026-03-01T08:20:00Z",
    "operator": "K. Ito", "notes": "after transport",
}  # fmt: skip
AXIS_DIGITS = 10
"""Decimals of axes: 2e-5 arcsec."""


def session_template(pattern: CalibrationSession, made: datetime, language: Language = Language.ENGLISH) -> bytes:
    """The workbook for the next session, like a given one."""
    document = session_document(pattern)
    target = io.BytesIO()
    book = xlsxwriter.Workbook(target, {**OPTIONS, "constant_memory": False})
    book.set_properties({"title": "imu-session/1", "author": "imu-health", "created": naive(made)})
    words = wording(language, [sensor["name"] for sensor in document["sensors"]])
    style = Style(_looks(book), words)
    _session_sheet(book.add_worksheet(words.sheet("session")), style, document)
    _readings_sheet(book.add_worksheet(words.sheet("readings")), style, document)
    _example_sheet(book.add_worksheet(words.sheet("example")), style, document)
    book.close()
    return target.getvalue()


@dataclass(frozen=True)
class Style:
    """Formats and words of cells."""

    looks: dict[str, Format]
    words: Wording


def _looks(book: xlsxwriter.Workbook) -> dict[str, Format]:
    """Locked headings; yellow cells to fill in; grey hints."""
    return {
        "head": book.add_format({"bold": True, "bottom": 1, "bg_color": "#e8eef4"}),
        "asked": book.add_format({"locked": False, "bg_color": "#fff2b3", "border": 1, "num_format": "@"}),
        "reading": book.add_format({"locked": False, "bg_color": "#fff2b3", "border": 1}),
        "given": book.add_format({"locked": False}),
        "hint": book.add_format({"font_color": "#555555", "text_wrap": True, "valign": "top"}),
    }


def _session_sheet(sheet: Worksheet, style: Style, document: Json) -> None:
    """Keys, values, and hints; yellow cells are to be filled in."""
    sheet.set_column(0, 0, 30)
    sheet.set_column(1, 1, 34)
    sheet.set_column(2, 2, 80)
    words = style.words
    for row, (key, value) in enumerate(_rows(document)):
        step = key.rpartition(".")[2]
        is_open = value in ("", None)
        sheet.write_string(row, 0, words.key(key), style.looks["head"])
        _write(sheet, (row, 1), words.value(step, value), style.looks["asked" if is_open else "given"])
        hint = words.say(KEY_HINTS.get(key) or KEY_HINTS.get(step, ""))
        note = f" {words.say(NEEDED_HERE)}" if is_open and key in ("unit", "stand.id") else ""
        sheet.write_string(row, 2, hint + note, style.looks["hint"])
        _check(sheet, (row, 1, row, 1), step, hint, words)
    sheet.protect("", {"format_columns": True, "format_rows": True})


def _rows(document: Json) -> Iterator[tuple[str, Any]]:
    """Keys and known values, the fields to fill in after the format; the origin is "measured"."""
    known = {key: value for key, value in document.items() if key not in NOT_COPIED}
    yield "format", known.pop("format")
    yield from ((key, "") for key in FILLED_IN)
    yield from _flat(known, "")


def _flat(node: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Any]]:
    """Dotted keys; sensors with their numbers; lists as JSON."""
    for key, value in node.items():
        place = f"{prefix}.{key}" if prefix else key
        if isinstance(value, Mapping):
            yield from _flat(value, place)
        elif key == "sensors":
            for number, sensor in enumerate(value, start=1):
                yield from _flat(sensor, f"sensors[{number}]")
        elif isinstance(value, list):
            yield place, json.dumps(_short(value))
        else:
            yield place, value


def _short(value: Any) -> Any:
    """Axes without superfluous digits."""
    if isinstance(value, list):
        return [_short(item) for item in value]
    return round(value, AXIS_DIGITS) + 0.0 if isinstance(value, float) else value


def _readings_sheet(sheet: Worksheet, style: Style, document: Json) -> None:
    """The schedule, and empty columns for measured values."""
    columns = _columns(document)
    planned = len(next(iter(columns.values()))) <= MOST_PLANNED and "sample_rate_hz" not in document
    _headings(sheet, style, document, list(columns))
    sheet.set_column(0, len(columns) - 1, 14, style.looks["given"])
    sensors = {sensor["name"] for sensor in document["sensors"]}
    for place, (name, cells) in enumerate(columns.items()):
        is_measured = name in MEASURED or name in sensors or name.removesuffix("_se") in sensors
        rows = len(cells) if planned else 0
        for row in range(rows):
            cell = "" if is_measured else style.words.value(name, cells[row])
            _write(sheet, (row + 1, place), cell, style.looks["reading" if name in sensors else "given"])
        _check(sheet, (1, place, max(ROOM, rows), place), name, style.words.say(_hint(name, document)), style.words)
    sheet.protect("", {"format_columns": True, "insert_rows": True, "delete_rows": True, "sort": True})


def _columns(document: Json) -> Json:
    table = dict(document["table"])
    rows = len(next(iter(table.values())))
    sensors = [sensor["name"] for sensor in document["sensors"]]
    settings = {name: cells for name, cells in table.items() if name.removesuffix("_se") not in sensors}
    settings = {**settings, **{name: settings.get(name, [None] * rows) for name in MEASURED[:2]}}
    readings = {name: table[name] for name in sensors}
    if "sample_rate_hz" in document:
        return settings | readings
    return settings | readings | {f"{name}_se": table.get(f"{name}_se", [None] * rows) for name in sensors}


def _headings(sheet: Worksheet, style: Style, document: Json, names: list[str]) -> None:
    for place, name in enumerate(names):
        sheet.write_string(0, place, style.words.heading(name), style.looks["head"])
        sheet.write_comment(0, place, style.words.say(_hint(name, document)), {"author": "imu-health"})
    sheet.freeze_panes(1, 0)


def _hint(name: str, document: Json) -> str:
    for sensor in document["sensors"]:
        if name == sensor["name"]:
            return reading_hint(name, sensor["reading_unit"])
        if name == f"{sensor['name']}_se":
            return standard_error_hint(sensor["name"], sensor["reading_unit"])
    return COLUMN_HINTS.get(name, "")


def _example_sheet(sheet: Worksheet, style: Style, document: Json) -> None:
    """Writes a sheet with the first rows filled in, and example values next to them; ignored by an upload."""
    columns = _columns(document)
    _headings(sheet, style, document, list(columns))
    sheet.set_column(0, len(columns) + 2, 14)
    for place, (name, cells) in enumerate(columns.items()):
        for row, cell in enumerate(cells[:MOST_SHOWN]):
            _write(sheet, (row + 1, place), style.words.value(name, cell), style.looks["given"])
    example_column = len(columns) + 1
    sheet.set_column(example_column, example_column, 26)
    sheet.set_column(example_column + 1, example_column + 1, 26)
    sheet.write_string(0, example_column, style.words.say("on the sheet session"), style.looks["head"])
    for row, (key, value) in enumerate(EXAMPLE.items(), start=1):
        sheet.write_string(row, example_column, style.words.key(key), style.looks["hint"])
        sheet.write_string(row, example_column + 1, value)
    sheet.protect()


def _write(sheet: Worksheet, place: tuple[int, int], value: Any, look: Format) -> None:
    if value in ("", None):
        sheet.write_blank(*place, None, look)
    elif isinstance(value, int | float):
        sheet.write_number(*place, value, look)
    else:
        write_text(sheet, place, str(value), look)


def _check(sheet: Worksheet, cells: tuple[int, int, int, int], name: str, hint: str, words: Wording) -> None:
    """A drop-down, bounds, or the hint alone while the cell is being filled in."""
    rule: dict[str, Any] = {"validate": "any"}
    quantity = words.heading(words.key(name))
    if name in CHOICES:
        rule = {"validate": "list", "source": [words.value(name, choice) for choice in CHOICES[name]]}
        rule["error_message"] = words.say(say("Choose one of the list for {quantity}.", quantity=quantity))
    elif name in LIMITS:
        low, high = LIMITS[name]
        rule = {"validate": "decimal", "criteria": "between", "minimum": low, "maximum": high}
        rule["error_message"] = words.say(
            say("{quantity} is a number from {low} to {high}.", quantity=quantity, low=f"{low:g}", high=f"{high:g}")
        )
    if hint or name in CHOICES:
        input_options = {"input_title": quantity[:32], "input_message": hint[:255], "ignore_blank": True}
        sheet.data_validation(*cells, {**rule, **input_options})
