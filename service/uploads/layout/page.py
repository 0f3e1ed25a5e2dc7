"""The page of a table of custom layout: the mapping of each column, the missing facts, and the first rows."""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from estimator.errors import Problem
from estimator.json_object import Json
from estimator.message import say
from estimator.reading.keys import COLUMNS
from estimator.session import ACCELEROMETER, GYROSCOPE, PROGRAMMES
from service.ingest.layout.kinds import KINDS, is_sensor, kinds_of
from service.ingest.layout.mapping import ENCODINGS
from service.kit.measures import number
from service.planning.rules import SoFar
from service.uploads.layout.form import Carried, LayoutForm, half_angle_of, moment
from service.uploads.layout.words import FACTS, KINDS_CALLED, LABELS, PLACES, RARE, said_on_page
from service.uploads.preview import Preview, felt_length, first_rows

MOST_SHOWN = 30
"""Columns that are always shown; further ignored ones are behind a click."""
NEW_SENSORS = 12
"""Offered names of sensors where none is known."""
UNITS = (
    "V", "mV", "µV", "mA", "µA", "count", "pulse", "m/s²", "g", "mg", "rad/s", "°/s", "mdeg/s", "°/h", "deg", "rad",
    "arcmin", "arcsec", "s", "ms", "µs", "ns", "min", "h", "°C", "K", "°F",
)  # fmt: skip
SEPARATORS = {";": "semicolon ;", ",": "comma ,", "\t": "tab", "|": "bar |", " ": "blanks"}
DECIMALS = {".": "point 0.5", ",": "comma 0,5"}
OFFSETS = (
    "-12:00", "-11:00", "-10:00", "-09:30", "-09:00", "-08:00", "-07:00", "-06:00", "-05:00", "-04:00", "-03:30",
    "-03:00", "-02:30", "-02:00", "-01:00", "Z", "+01:00", "+02:00", "+03:00", "+03:30", "+04:00", "+04:30", "+05:00",
    "+05:30", "+05:45", "+06:00", "+06:30", "+07:00", "+08:00", "+08:45", "+09:00", "+09:30", "+10:00", "+10:30",
    "+11:00", "+12:00", "+12:45", "+13:00", "+13:45", "+14:00",
)  # fmt: skip
"""Offsets from UTC of the time zones in use."""


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
    kinds: tuple[Choice, ...]
    meaning: str
    choices: tuple[Choice, ...]
    unit: str
    has_unit: bool
    words: tuple[tuple[str, str], ...]
    """Words of the run, with their meaning."""
    all_words: str
    empty: bool
    sensor: "SensorFields | None" = None


@dataclass(frozen=True)
class SensorFields:
    """One sensor with its known facts."""

    name: str
    kind: str
    axis: str
    scale: str
    unit: str

    @property
    def is_backwards(self) -> bool:
        """Whether it is a gyro whose input axis points against one of the block's axes."""
        return self.kind == GYROSCOPE and sorted(self.axis.split()) == ["-1", "0", "0"]


@dataclass(frozen=True)
class FactField:
    """One field of the session."""

    key: str
    label: str
    value: str
    mode: str


@dataclass(frozen=True)
class LayoutPage:
    """Contents of the page."""

    filename: str
    carried: Carried
    mapping: str
    remembered: bool
    rows: str
    columns: tuple[ColumnRow, ...]
    more: tuple[ColumnRow, ...]
    """Ignored columns of a wide table."""
    left_out: int
    """Number of empty columns."""
    taken: tuple[tuple[str, str, tuple[Choice, ...]], ...]
    """Key, label and choices of the parser's settings."""
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
    problems: tuple[Problem, ...]
    preview: tuple[tuple[str, ...], ...]
    headings: tuple[str, ...]
    felt: str
    cone_angle: str
    arrangement: str
    """Chosen before, where it could not be followed."""
    units: tuple[str, ...] = UNITS
    lines: tuple[str, ...] = ()
    """First lines of a text that cannot be cut yet."""
    so_far: SoFar | None = None
    sensorless: bool = False
    is_sampled: bool = False
    """Whether only its first rows were read."""
    can_store: bool = False
    changed: bool = False
    """Whether it was confirmed, but differs from the shown page."""


def layout_page(carried: Carried, preview: Preview, form: LayoutForm, types: Sequence[str]) -> LayoutPage:
    """The page for a mapping."""
    mapping, session = preview.mapping, preview.mapping["session"]
    day, clock, offset = moment(session)
    like = form.like or str(session.get("unit_type") or "")
    like = like if like in types else ""
    columns = tuple(_columns(preview))
    filled_columns = tuple(column for column in columns if not column.empty)
    shown = tuple(column for column in filled_columns if column.meaning or column.place < MOST_SHOWN)
    problems = said_on_page(_dated(preview.problems, day), mapping)
    return LayoutPage(
        filename=form.file.filename,
        carried=carried,
        mapping=json.dumps(mapping, ensure_ascii=False),
        remembered=preview.remembered,
        rows=f"{preview.seen['rows']:,}",
        columns=shown,
        more=tuple(column for column in filled_columns if column not in shown),
        left_out=sum(column.empty for column in columns),
        taken=tuple(_taken(preview)),
        numbers=tuple(_row_fields(mapping["table"], preview.seen["kind"])),
        lines=tuple(preview.seen["lines"]),
        unit=str(session.get("unit") or ""),
        unit_type=str(session.get("unit_type") or ""),
        like=like,
        types=_choices(types, like),
        day=day,
        clock=clock,
        offsets=_choices(tuple(dict.fromkeys((*OFFSETS, offset or "Z"))), offset or "Z"),
        texts=tuple(
            FactField(key.removeprefix("fact."), label, str(session.get(s) or ""), "text") for key, label, s in FACTS
        ),
        programmes=_choices(PROGRAMMES, str(session.get("programme", ""))),
        blocks=_choices((ACCELEROMETER, GYROSCOPE), str(session.get("block", ""))),
        places=_fields(PLACES, session),
        rare=_fields(RARE, session),
        sensorless=not any(column.sensor for column in columns),
        problems=problems,
        arrangement=form.fields.get("arrangement", "") if half_angle_of(form.fields) is None else "",
        cone_angle=form.fields.get("cone_angle", ""),
        so_far=preview.so_far,
        is_sampled=preview.seen["sampled"],
        can_store=not problems,
        changed=form.fields.get("do") == "store" and not problems,
        **_first(preview),
    )


def _dated(problems: tuple[Problem, ...], day: str) -> tuple[Problem, ...]:
    """A history needs the day, which a session file may omit."""
    return problems if day else (*problems, Problem("started_at", "missing; state the day of measurement"))


def _choices(values: Sequence[str], chosen: str) -> tuple[Choice, ...]:
    return tuple(Choice(value, value, value == chosen) for value in values)


def _columns(preview: Preview) -> Iterator[ColumnRow]:
    sensors, columns = _sensor_names(preview), preview.mapping["columns"]
    session = preview.mapping["session"]
    kinds = kinds_of([column.get("as") for column in columns], session)
    known = {s.get("name"): _sensor(s, session) for s in session.get("sensors") or () if isinstance(s, dict)}
    for place, (source, column) in enumerate(zip(preview.seen["columns"], columns, strict=True)):
        meaning = column.get("as") or ""
        words = column.get("words") or {}
        yield ColumnRow(
            place,
            source["heading"],
            tuple(source["cells"]),
            tuple(Choice(kind, KINDS_CALLED[kind], kind == kinds[place]) for kind in KINDS),
            meaning,
            tuple(_meanings(meaning, sensors)),
            column.get("unit") or "",
            meaning not in ("run", "position"),
            tuple(words.items()) if meaning == "run" else (),
            "\t".join(source["words"]),
            source["empty"] and not meaning,
            known.get(meaning),
        )


def _sensor_names(preview: Preview) -> list[str]:
    """Known names, and new ones."""
    known = [str(s.get("name", "")) for s in preview.mapping["session"].get("sensors") or () if isinstance(s, dict)]
    used = [column["as"] for column in preview.mapping["columns"] if column.get("as") and is_sensor(column["as"])]
    letters = "GA" if preview.mapping["session"].get("block") == GYROSCOPE else "AG"
    unused = [f"{letter}{k}" for letter in letters for k in range(1, NEW_SENSORS + 1)]
    return list(dict.fromkeys((*known, *used, *unused)))


def _meanings(meaning: str, sensors: Sequence[str]) -> Iterator[Choice]:
    yield Choice("", "left out", not meaning)
    for name in sensors:
        yield Choice(name, name, name == meaning)
    for key in COLUMNS:
        yield Choice(key, LABELS.get(key, key), key == meaning)
    for name in sensors:
        yield Choice(f"{name}_se", say("standard error of {name}", name=name), f"{name}_se" == meaning)


def _taken(preview: Preview) -> Iterator[tuple[str, str, tuple[Choice, ...]]]:
    table = preview.mapping["table"]
    if preview.seen["sheets"]:
        yield "sheet", "Sheet", _choices(tuple(preview.seen["sheets"]), str(table.get("sheet")))
    if preview.seen["kind"] == "text":
        yield "encoding", "Encoding", _choices(tuple(dict.fromkeys((*ENCODINGS, table["encoding"]))), table["encoding"])
        separators = SEPARATORS | {table["separator"]: SEPARATORS.get(table["separator"], table["separator"])}
        yield (
            "separator",
            "Columns parted by",
            tuple(Choice(k, v, k == table["separator"]) for k, v in separators.items()),
        )
    if preview.seen["kind"] in ("text", "xlsx"):
        yield "decimal", "Decimal sign", tuple(Choice(k, v, k == table["decimal"]) for k, v in DECIMALS.items())


def _row_fields(table: Mapping[str, Any], kind: str) -> Iterator[FactField]:
    if kind == "text":
        yield FactField("sign", "Columns parted by another sign", "", "text")
        yield FactField("record", "Only rows that begin with", str(table.get("record", "")), "text")
    for key, label in (("header_row", "Headings in row"), ("first_row", "Readings from row")):
        if key in table and "header_row" in table:
            yield FactField(key, label, str(table[key]), "numeric")


def _fields(entries: Sequence[tuple[str, str, str]], session: Mapping[str, Any]) -> tuple[FactField, ...]:
    return tuple(FactField(key, label, _text_of(session, key), mode) for key, label, mode in entries)


def _text_of(session: Mapping[str, Any], key: str) -> str:
    parent, _, step = key.rpartition(".")
    node = session.get(parent) if parent else session
    value = node.get(step) if isinstance(node, Mapping) else None
    return "" if value is None else str(value)


def _sensor(sensor: Mapping[str, Any], session: Mapping[str, Any]) -> SensorFields:
    axis = sensor.get("nominal_axis") or ()
    shown = " ".join(str(part).removesuffix(".0") for part in axis) if isinstance(axis, list | tuple) else ""
    scale = sensor.get("nominal_scale")
    return SensorFields(
        str(sensor.get("name", "")),
        str(sensor.get("kind") or session.get("block") or ""),
        shown,
        "" if scale is None else str(scale),
        str(sensor.get("reading_unit") or ""),
    )


def _first(preview: Preview) -> Json:
    """The first rows as they will be read, and the length of the measured vector."""
    if preview.session is None:
        return {"preview": (), "headings": (), "felt": ""}
    rows = first_rows(preview.session)
    measure = "m/s²" if preview.session.block == ACCELEROMETER else "rad/s"
    units = {"beta_rad": "β, rad", "time_s": "t, s", "temperature_c": "T, °C", "run": "run"}
    headings = tuple(units.get(name, say("{name}, {measure}", name=name, measure=measure)) for name in rows[0])
    cells = tuple(tuple(value if isinstance(value, str) else number(value) for value in row.values()) for row in rows)
    length = felt_length(preview.session)
    return {
        "preview": cells,
        "headings": headings,
        "felt": say("{length} {measure}", length=number(length), measure=measure),
    }
