"""The page of a table of one's own layout: how each column is read, what is missing, and the first rows."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from estimator.errors import Problem
from estimator.message import say
from estimator.reading.keys import COLUMNS
from estimator.session import ACCELEROMETER, GYROSCOPE, PROGRAMMES
from service.ingest.layout.grids import ENCODINGS
from service.ingest.session_keys import COLUMN_HINTS
from service.kit.measures import number
from service.uploads.layout.form import Carried, LayoutForm, moment
from service.uploads.preview import Preview, felt_length, first_rows, is_sensor

MOST_SHOWN = 30
"""Columns that are shown whether they are read or not; further ones that are left out stand behind a click."""
NEW_SENSORS = 12
"""Names of sensors that are offered where none is known."""
UNITS = (
    "V", "mV", "µV", "mA", "µA", "count", "pulse", "m/s²", "g", "mg", "rad/s", "°/s", "°/h", "deg", "rad", "arcmin",
    "arcsec", "s", "ms", "min", "h", "°C", "K", "°F",
)  # fmt: skip
"""That are offered."""
SEPARATORS = {";": "semicolon ;", ",": "comma ,", "\t": "tab", "|": "bar |"}
DECIMALS = {".": "point 0.5", ",": "comma 0,5"}
OFFSETS = ("Z", *(f"{sign}{h:02}:00" for sign, hours in (("+", range(1, 15)), ("-", range(1, 13))) for h in hours))
LABELS = {
    "run": "run: direct or flipped", "beta_deg": "β, turn of the head", "time_s": "time",
    "temperature_c": "temperature",
    "vibration_m_s2": "vibration", "turn_angle_deg": "angle of the turntable", "turn_rate_deg_s": "rate of the table",
    "position": "position", "direction_x": "direction x", "direction_y": "direction y", "direction_z": "direction z",
}  # fmt: skip
"""What columns are called here."""
FACTS = (
    ("fact.operator", "Operator", "operator"), ("fact.notes", "Notes", "notes"),
)  # fmt: skip
PLACES = (
    ("stand.id", "Stand: name or number", "text"), ("stand.alpha_deg", "Elevation of the head's axis α, °", "decimal"),
    ("site.latitude_deg", "Latitude, °", "decimal"), ("site.gravity_m_s2", "or measured gravity, m/s²", "decimal"),
)  # fmt: skip
"""What is asked of the stand and the site."""
RARE = (
    ("stand.chi_deg", "Gyroscopes: elevation χ, °", "decimal"), ("count_time_s", "Pulses: count time, s", "decimal"),
    ("sample_rate_hz", "Raw log: samples a second", "decimal"),
    ("direction_sigma_deg", "Directions: known to, °", "decimal"),
)  # fmt: skip
"""What only some sessions need."""


@dataclass(frozen=True)
class Choice:
    """One option of a list."""

    value: str
    label: str
    chosen: bool


@dataclass(frozen=True)
class ColumnRow:
    """One column of the file."""

    place: int
    heading: str
    cells: tuple[str, ...]
    meaning: str
    choices: tuple[Choice, ...]
    unit: str
    has_unit: bool
    words: tuple[tuple[str, str], ...]
    """Of the run, and what each means."""
    all_words: str
    empty: bool


@dataclass(frozen=True)
class SensorRow:
    """One sensor with what is known of it."""

    name: str
    kind: str
    axis: str
    scale: str
    unit: str


@dataclass(frozen=True)
class FactField:
    """One field of the session."""

    key: str
    label: str
    value: str
    mode: str


@dataclass(frozen=True)
class LayoutPage:
    """Everything the page shows."""

    filename: str
    carried: Carried
    mapping: str
    remembered: bool
    rows: str
    columns: tuple[ColumnRow, ...]
    more: tuple[ColumnRow, ...]
    """Columns of a wide table that are left out."""
    left_out: int
    """Columns that say nothing."""
    taken: tuple[tuple[str, str, tuple[Choice, ...]], ...]
    """Key, label and choices of how the file is taken apart."""
    numbers: tuple[FactField, ...]
    unit: str
    unit_type: str
    like: str
    types: tuple[Choice, ...]
    day: str
    clock: str
    offsets: tuple[Choice, ...]
    texts: tuple[FactField, ...]
    programmes: tuple[Choice, ...]
    blocks: tuple[Choice, ...]
    places: tuple[FactField, ...]
    rare: tuple[FactField, ...]
    sensors: tuple[SensorRow, ...]
    problems: tuple[Problem, ...]
    preview: tuple[tuple[str, ...], ...]
    headings: tuple[str, ...]
    felt: str
    units: tuple[str, ...] = UNITS
    can_store: bool = False
    changed: bool = False
    """Whether it was to be stored, but not as it was shown before."""


def layout_page(carried: Carried, found: Preview, form: LayoutForm, types: Sequence[str]) -> LayoutPage:
    """The page under the mapping at hand."""
    mapping, session = found.mapping, found.mapping["session"]
    day, clock, offset = moment(session)
    like = form.like or str(session.get("unit_type") or "")
    like = like if like in types else ""
    columns = tuple(_columns(found))
    filled = tuple(column for column in columns if not column.empty)
    shown = tuple(column for column in filled if column.meaning or column.place < MOST_SHOWN)
    dated = _dated(found.problems, day)
    return LayoutPage(
        filename=form.file.filename,
        carried=carried,
        mapping=json.dumps(mapping, ensure_ascii=False),
        remembered=found.remembered,
        rows=f"{found.seen['rows']:,}",
        columns=shown,
        more=tuple(column for column in filled if column not in shown),
        left_out=sum(column.empty for column in columns),
        taken=tuple(_taken(found)),
        numbers=tuple(_row_fields(mapping["table"])),
        unit=str(session.get("unit") or ""),
        unit_type=str(session.get("unit_type") or ""),
        like=like,
        types=_choices(types, like),
        day=day,
        clock=clock,
        offsets=_choices(OFFSETS, offset or "Z"),
        texts=tuple(
            FactField(key.removeprefix("fact."), label, str(session.get(s) or ""), "text") for key, label, s in FACTS
        ),
        programmes=_choices(PROGRAMMES, str(session.get("programme", ""))),
        blocks=_choices((ACCELEROMETER, GYROSCOPE), str(session.get("block", ""))),
        places=_fields(PLACES, session),
        rare=_fields(RARE, session),
        sensors=tuple(_sensor(s, session) for s in session.get("sensors") or () if isinstance(s, dict)),
        problems=dated,
        can_store=not dated,
        changed=form.fields.get("do") == "store" and not dated,
        **_first(found),
    )


def _dated(problems: tuple[Problem, ...], day: str) -> tuple[Problem, ...]:
    """A history needs the day, which a session file may leave out."""
    return problems if day else (*problems, Problem("started_at", "missing; state the day of measurement"))


def _choices(values: Sequence[str], chosen: str) -> tuple[Choice, ...]:
    return tuple(Choice(value, value, value == chosen) for value in values)


def _columns(found: Preview) -> Iterator[ColumnRow]:
    sensors = _sensor_names(found)
    for place, (seen, column) in enumerate(zip(found.seen["columns"], found.mapping["columns"], strict=True)):
        meaning = column.get("as") or ""
        words = column.get("words") or {}
        yield ColumnRow(
            place,
            seen["heading"],
            tuple(seen["cells"]),
            meaning,
            tuple(_meanings(meaning, sensors)),
            column.get("unit") or "",
            meaning not in ("run", "position"),
            tuple(words.items()) if meaning == "run" else (),
            "\t".join(seen["words"]),
            seen["empty"] and not meaning,
        )


def _sensor_names(found: Preview) -> list[str]:
    """Those that are known, and names for further ones."""
    known = [str(s.get("name", "")) for s in found.mapping["session"].get("sensors") or () if isinstance(s, dict)]
    used = [column["as"] for column in found.mapping["columns"] if column.get("as") and is_sensor(column["as"])]
    letter = "G" if found.mapping["session"].get("block") == GYROSCOPE else "A"
    free = [f"{letter}{k}" for k in range(1, NEW_SENSORS + 1)]
    return list(dict.fromkeys((*known, *used, *free)))


def _meanings(meaning: str, sensors: Sequence[str]) -> Iterator[Choice]:
    yield Choice("", "left out", not meaning)
    for name in sensors:
        yield Choice(name, say("reading of {name}", name=name), name == meaning)
    for key in COLUMNS:
        yield Choice(key, LABELS.get(key, key), key == meaning)
    for name in sensors:
        yield Choice(f"{name}_se", say("standard error of {name}", name=name), f"{name}_se" == meaning)


def _taken(found: Preview) -> Iterator[tuple[str, str, tuple[Choice, ...]]]:
    table = found.mapping["table"]
    if found.seen["sheets"]:
        yield "sheet", "Sheet", _choices(tuple(found.seen["sheets"]), str(table.get("sheet")))
    if found.seen["kind"] == "text":
        yield "encoding", "Encoding", _choices(tuple(dict.fromkeys((*ENCODINGS, table["encoding"]))), table["encoding"])
        separators = SEPARATORS | {table["separator"]: SEPARATORS.get(table["separator"], table["separator"])}
        yield (
            "separator",
            "Columns parted by",
            tuple(Choice(k, v, k == table["separator"]) for k, v in separators.items()),
        )
    if found.seen["kind"] in ("text", "xlsx"):
        yield "decimal", "Decimal sign", tuple(Choice(k, v, k == table["decimal"]) for k, v in DECIMALS.items())


def _row_fields(table: Mapping[str, Any]) -> Iterator[FactField]:
    for key, label in (("header_row", "Headings in row"), ("first_row", "Readings from row")):
        if key in table and "header_row" in table:
            yield FactField(key, label, str(table[key]), "numeric")


def _fields(asked: Sequence[tuple[str, str, str]], session: Mapping[str, Any]) -> tuple[FactField, ...]:
    return tuple(FactField(key, label, _said(session, key), mode) for key, label, mode in asked)


def _said(session: Mapping[str, Any], key: str) -> str:
    parent, _, step = key.rpartition(".")
    node = session.get(parent) if parent else session
    value = node.get(step) if isinstance(node, Mapping) else None
    return "" if value is None else str(value)


def _sensor(sensor: Mapping[str, Any], session: Mapping[str, Any]) -> SensorRow:
    axis = sensor.get("nominal_axis") or ()
    shown = " ".join(map(str, axis)) if isinstance(axis, list | tuple) else ""
    scale = sensor.get("nominal_scale")
    return SensorRow(
        str(sensor.get("name", "")),
        str(sensor.get("kind") or session.get("block") or ""),
        shown,
        "" if scale is None else str(scale),
        str(sensor.get("reading_unit") or ""),
    )


def _first(found: Preview) -> dict[str, Any]:
    """The first rows as they will be read, and the length of what they say was felt."""
    if found.session is None:
        return {"preview": (), "headings": (), "felt": ""}
    rows = first_rows(found.session)
    measure = "m/s²" if found.session.block == ACCELEROMETER else "rad/s"
    units = {"beta_rad": "β, rad", "time_s": "t, s", "temperature_c": "T, °C", "run": "run"}
    headings = tuple(units.get(name, say("{name}, {measure}", name=name, measure=measure)) for name in rows[0])
    cells = tuple(tuple(value if isinstance(value, str) else number(value) for value in row.values()) for row in rows)
    length = felt_length(found.session)
    return {
        "preview": cells,
        "headings": headings,
        "felt": say("{length} {measure}", length=number(length), measure=measure),
    }


HINTS = COLUMN_HINTS
