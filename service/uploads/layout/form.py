"""The form of a mapping: corrections by hand, applied to the mapping it was made from."""

import base64
import binascii
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from math import cos, radians, sin
from typing import Annotated, Any

from fastapi import Depends, Request
from starlette.concurrency import run_in_threadpool
from starlette.datastructures import UploadFile

from estimator.errors import Problem
from estimator.json_object import Json
from estimator.message import say
from estimator.simulate import cone
from service.errors import RefusedError
from service.ingest.layout.kinds import first_of, is_sensor, kinds_of
from service.ingest.layout.understand import run_words, split_unit
from service.ingest.layout.vocabulary import LETTERS, conversion
from service.kit.arriving_files import Content
from service.kit.limits import in_force
from service.kit.text import fault_of_text, with_plain_ends
from service.people.admission import PersonOf
from service.people.dependencies import StorageOf
from service.sessions.sent import SentFile
from service.storage.aside import aside, set_aside
from service.storage.files import Files
from service.web.dependencies import Now, UploadSlotOf, limited

MOST_FIELDS = 5000
"""Most fields of the form: two for each of 300 columns, a few for each sensor."""
INFLATION = 1.4
"""Growth of bytes encoded as text: 4/3, and the form around them."""
CHOSEN = ("sheet", "encoding", "separator", "record", "decimal", "header_row", "first_row")
"""Settings of the parser that can be chosen; what follows one that was changed is understood anew."""
TEXTS = ("unit", "unit_type", "operator", "notes", "programme", "block", "stand.id")
NUMBERS = (
    "stand.alpha_deg", "stand.chi_deg", "site.latitude_deg", "site.gravity_m_s2", "time_since_power_on_s",
    "count_time_s", "sample_rate_hz", "direction_sigma_deg",
)  # fmt: skip
"""Facts of the session in the form."""
ORTHOGONAL = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
HALF_ANGLE = 54.735610317245346
"""Degrees, of the cone on which three axes are orthogonal: its cosine is 1/√3."""
CONES = {"cone": (1.0, 1.0, -1.0), "cone-simulated": (1.0, 1.0, 1.0)}
"""Arrangements on a cone about y, the first axis towards x, with the signs of their components against `cone`: the
next axes towards z, or away from it."""
CONE_ANGLE = "Half-angle of the cone"
"""Label of a field that no mapping has."""
DIRECTION = 2
"""Numbers of an azimuth and an elevation."""
AXIS = re.compile(r"sensor\..+\.axis")
"""Field of an input axis."""


@dataclass(frozen=True)
class LayoutForm:
    """Contents of the form."""

    file: SentFile
    """Sent file; empty where it was not sent again."""
    fields: Mapping[str, str]
    mapping: Json | None
    """Mapping of the previous page; None at first."""
    owner: str = ""
    """Login of the sender; empty where there are no accounts."""

    @property
    def unit(self) -> str:
        """The serial number as written."""
        return self.fields.get("fact.unit", "").strip()

    @property
    def like(self) -> str:
        """The unit type whose facts are used."""
        return self.fields.get("like", "")

    @property
    def is_other_type(self) -> bool:
        """Whether another type was chosen than that of the facts."""
        return self.like != self.fields.get("was_like", self.like)

    @property
    def is_other_unit(self) -> bool:
        """Whether another unit was named than that of the facts."""
        return self.unit != self.fields.get("was_unit", "")


async def _form(request: Request, storage: StorageOf, person: PersonOf, now: Now, _: UploadSlotOf) -> LayoutForm:
    limit = int(in_force().whole * INFLATION)
    body = limited(request, limit, is_form=True)
    async with body.form(max_files=1, max_fields=MOST_FIELDS, max_part_size=limit) as form:
        file, text = form.get("file"), form.get("content")
        fields = {name: value for name, value in form.items() if isinstance(value, str) and name != "content"}
        content: Content = await file.read() if isinstance(file, UploadFile) else b""
        name = file.filename if isinstance(file, UploadFile) and file.filename else fields.get("filename", "table")
    _require_text(fields)
    if not content and isinstance(text, str):
        content = _bytes(text)
    if not content and fields.get("aside"):
        content = await run_in_threadpool(aside, storage.files, person.login, fields["aside"], now) or b""
    return LayoutForm(SentFile(name, content), fields, _mapping(fields.get("mapping", "")), person.login)


def _require_text(fields: Mapping[str, str]) -> None:
    """RefusedError where something that was written is no text; the mapping is data."""
    faults = ((name, fault_of_text(with_plain_ends(text))) for name, text in fields.items() if name != "mapping")
    problems = tuple(Problem(name, fault) for name, fault in faults if fault)
    if problems:
        raise RefusedError("The form cannot be used.", problems)


@dataclass(frozen=True)
class Carried:
    """Table returned with its page: one of the two is set."""

    content: str = ""
    """Bytes of a small table as text."""
    aside: str = ""
    """The hash under which it is stored temporarily."""


def carried(files: Files, owner: str, file: SentFile, now: datetime) -> Carried:
    """Bytes as text for a small table, which arrived in memory; a larger one is stored temporarily."""
    if isinstance(file.content, bytes):
        return Carried(base64.b64encode(file.content).decode())
    return Carried(aside=set_aside(files, owner, file.content, now))


LayoutFormOf = Annotated[LayoutForm, Depends(_form)]


def _bytes(text: str) -> bytes:
    try:
        return base64.b64decode(text, validate=True)
    except binascii.Error as fault:
        raise RefusedError(
            "The form is damaged: upload the file again.", (Problem("content", "is damaged"),)
        ) from fault


def _mapping(text: str) -> Json | None:
    if not text:
        return None
    try:
        document = json.loads(text)
    except ValueError as fault:
        raise RefusedError(
            "The form is damaged: upload the file again.", (Problem("mapping", "is damaged"),)
        ) from fault
    if not isinstance(document, dict) or not isinstance(document.get("columns"), list):
        raise RefusedError("The form is damaged: upload the file again.", (Problem("mapping", "is damaged"),))
    return document


def corrected(form: LayoutForm) -> Json | None:
    """The mapping with everything that was chosen or written; None where there is none to correct yet."""
    if form.mapping is None:
        return None
    fields, before = form.fields, form.mapping
    table = dict(before.get("table", {})) | _chosen(fields, before.get("table", {}))
    is_same = all(table.get(key) == value for key, value in before.get("table", {}).items())
    columns = [_column(fields, k, column) for k, column in enumerate(before["columns"])] if is_same else []
    kinds = _kinds(fields, before, columns)
    if not is_same:
        changed = [key for key in CHOSEN if table.get(key) != before.get("table", {}).get(key)]
        kept = (*CHOSEN[: CHOSEN.index(changed[0])], *changed)
        table = {key: table[key] for key in kept if key in table}
    return {
        **before,
        "table": table,
        "columns": columns,
        "session": _session(fields, before.get("session", {}), columns, kinds),
    }


def _kinds(fields: Mapping[str, str], before: Mapping[str, Any], columns: list[Json]) -> dict[str, str]:
    """Kinds of the sensors. A column of another kind than before becomes the first of that kind, unless it was also
    chosen what it is; a sensor of another kind keeps its name."""
    known = before.get("session", {})
    was = [column.get("as") if isinstance(column, dict) else None for column in before["columns"]]
    kinds = kinds_of([column["as"] for column in columns], known if isinstance(known, dict) else {})
    for k, (column, kind) in enumerate(zip(columns, kinds, strict=True)):
        chosen = fields.get(f"kind.{k}", kind)
        if column["as"] != (was[k] or None) or chosen == kind:
            continue
        kinds[k] = chosen
        if not (chosen in LETTERS and is_sensor(column["as"] or "")):
            column["as"] = first_of(chosen, [other["as"] for other in columns])
            if column["as"] in (None, "run", "position"):
                column.pop("unit", None)
    return {column["as"]: kind for column, kind in zip(columns, kinds, strict=True) if is_sensor(column["as"] or "")}


def _chosen(fields: Mapping[str, str], before: Mapping[str, Any]) -> Json:
    """Settings of the parser; an empty kind of record means rows of all kinds."""
    settings: Json = {}
    fields = {**fields, "table.separator": fields.get("table.sign") or fields.get("table.separator", "")}
    for key in CHOSEN:
        text = fields.get(f"table.{key}", "")
        if text or (key == "record" and before.get(key) and f"table.{key}" in fields):
            settings[key] = int(text) if text.isdecimal() and key.endswith("_row") else text
    return settings


def _column(fields: Mapping[str, str], k: int, before: Any) -> Json:
    known = before if isinstance(before, dict) else {}
    meaning, unit = fields.get(f"as.{k}", known.get("as") or ""), fields.get(f"unit.{k}", known.get("unit") or "")
    heading = str(known.get("heading", ""))
    column: Json = {"heading": heading, "as": meaning or None}
    if meaning and (unit.strip() or split_unit(heading)[1]) and meaning not in ("run", "position"):
        column["unit"] = unit.strip()
    if meaning == "run":
        words = known.get("words") or run_words(fields.get(f"words.{k}", "").split("\t"))
        column["words"] = {word: fields.get(f"word.{k}.{i}", now) for i, (word, now) in enumerate(words.items())}
    if known.get("fill_down") and meaning in ("run", "position"):
        column["fill_down"] = True
    return column


def _session(fields: Mapping[str, str], before: Any, columns: list[Json], kinds: Mapping[str, str]) -> Json:
    """The facts with those from the form; an empty field states nothing."""
    session = json.loads(json.dumps(before if isinstance(before, dict) else {}))
    for key in (*TEXTS, *NUMBERS):
        if f"fact.{key}" in fields:
            _put(session, key, _value(fields[f"fact.{key}"]) if key in NUMBERS else fields[f"fact.{key}"].strip())
    if fields.get("fact.day"):
        session["started_at"] = _started(fields)
    if columns:
        session["sensors"] = _sensors(fields, session, columns, kinds)
    return {key: value for key, value in session.items() if value not in (None, "")}


def _started(fields: Mapping[str, str]) -> str:
    """``2026-03-01T09:00:00+03:00``."""
    clock = fields.get("fact.clock") or "12:00"
    return f"{fields['fact.day']}T{clock if clock.count(':') > 1 else f'{clock}:00'}{fields.get('fact.offset') or 'Z'}"


def moment(session: Mapping[str, Any]) -> tuple[str, str, str]:
    """Day, clock and offset of a session's start, as the form shows them."""
    try:
        start = datetime.fromisoformat(str(session.get("started_at", "")))
    except ValueError:
        return "", "", ""
    offset = start.strftime("%z")
    return (
        start.date().isoformat(),
        start.strftime("%H:%M"),
        "Z" if offset in ("", "+0000") else f"{offset[:3]}:{offset[3:]}",
    )


def _put(session: Json, key: str, value: Any) -> None:
    parent, _, step = key.rpartition(".")
    node = session.setdefault(parent, {}) if parent else session
    if not isinstance(node, dict):
        return
    if value in (None, ""):
        node.pop(step, None)
        if key == "stand.id" and node:
            node["id"] = ""
    else:
        node[step] = value
    if parent and not node:
        session.pop(parent)


def _value(text: str) -> float | str | None:
    """A number, with a decimal comma too; any other text is kept, so that it is refused under its name."""
    text = text.strip().removesuffix("°").rstrip()
    try:
        return float(text.replace(",", ".").replace("−", "-")) if text else None
    except ValueError:
        return text


def _sensors(
    fields: Mapping[str, str], session: Mapping[str, Any], columns: list[Json], kinds: Mapping[str, str]
) -> list[Json]:
    """One sensor per column of readings, with known facts and those from the form."""
    known = {s.get("name"): s for s in session.get("sensors") or () if isinstance(s, dict)}
    sensor_columns = [column for column in columns if column["as"] and is_sensor(column["as"])]
    axes = _arranged(fields, len(sensor_columns))
    sensors = []
    for column, axis in zip(sensor_columns, axes, strict=True):
        name = column["as"]
        sensor = {"reading_unit": column.get("unit", ""), **known.get(name, {}), "name": name}
        written = {key: fields.get(f"sensor.{name}.{key}") for key in ("axis", "scale", "unit")}
        was = sensor.get("kind") or session.get("block")
        if kinds[name] != was:
            sensor["kind"] = kinds[name]
        if written["axis"] is not None:
            sensor["nominal_axis"] = _axis(written["axis"])
        if axis is not None:
            sensor["nominal_axis"] = axis
        if written["scale"] is not None:
            sensor["nominal_scale"] = _value(written["scale"])
        if written["unit"]:
            sensor["reading_unit"] = written["unit"].strip()
        unit = column.get("unit", "")
        if unit and conversion(unit, sensor["reading_unit"]) is None and written["unit"] == known_unit(known, name):
            sensor = {**sensor, "reading_unit": unit, "nominal_scale": None}
        sensors.append({key: value for key, value in sensor.items() if value not in (None, "", [])})
    return sensors


def known_unit(sensors: Mapping[Any, Mapping[str, Any]], name: str) -> str:
    """The unit of a sensor's readings as the form showed it."""
    return str(sensors.get(name, {}).get("reading_unit") or "")


def _arranged(fields: Mapping[str, str], count: int) -> list[list[float] | None]:
    arrangement, half_angle = fields.get("arrangement", ""), half_angle_of(fields)
    if arrangement == "orthogonal" and count == len(ORTHOGONAL):
        return [list(axis) for axis in ORTHOGONAL]
    if arrangement in CONES and count and half_angle is not None:
        axes = cone(count, radians(half_angle)) * CONES[arrangement]
        return [[round(component, 10) + 0.0 for component in axis] for axis in axes.tolist()]
    return [None] * count


def half_angle_of(fields: Mapping[str, str]) -> float | None:
    """Half angle of the cone, degrees; None where the written number is no angle of one."""
    angle = _value(fields.get("cone_angle", ""))
    if angle is None:
        return HALF_ANGLE
    return angle if isinstance(angle, float) and 0 < angle < 90 else None


def _axis(text: str) -> list[float | str]:
    """Components of ``1 0 0`` or ``1; 0; 0`` or ``1, 0, 0``, with decimal commas where spaces or semicolons separate
    them; of two numbers, azimuth and elevation in degrees, those of their direction."""
    parts = text.replace(";", " ").split()
    parts = text.split(",") if len(parts) == 1 else parts
    numbers = [number for part in parts if (number := _value(part.strip(","))) is not None]
    if _fault_of_direction(numbers) or len(numbers) != DIRECTION or not all(isinstance(n, float) for n in numbers):
        return numbers
    azimuth, elevation = (radians(float(number)) for number in numbers)
    direction = (cos(elevation) * cos(azimuth), cos(elevation) * sin(azimuth), sin(elevation))
    return [round(component, 10) + 0.0 for component in direction]


def _fault_of_direction(numbers: Sequence[float | str]) -> str:
    """The fault of an azimuth and an elevation; empty where there is none, or where they are not given."""
    azimuth, elevation = numbers if len(numbers) == DIRECTION else ("", "")
    if isinstance(azimuth, str) or isinstance(elevation, str):
        return ""
    if not abs(azimuth) <= 360:
        return say("{angle}° is no azimuth (−360 to 360°)", angle=f"{azimuth:g}")
    if not abs(elevation) <= 90:
        return say("{angle}° is no elevation (−90 to 90°)", angle=f"{elevation:g}")
    return ""


def faults_of(form: LayoutForm) -> tuple[Problem, ...]:
    """The faults of numbers that are only in the form, and not in the mapping that is made from it."""
    fields = form.fields
    faults = [
        Problem(say("{name}: input axis", name=key.split(".")[1]), fault)
        for key, text in fields.items()
        if AXIS.fullmatch(key) and (fault := _fault_of_direction(_axis(text)))
    ]
    if fields.get("arrangement") in CONES and half_angle_of(fields) is None:
        said = say("{angle}° is no angle of a cone (0 to 90°)", angle=fields["cone_angle"].strip().removesuffix("°"))
        faults.append(Problem(CONE_ANGLE, said))
    return tuple(faults)


def filled_in(session: Mapping[str, Any], facts: Mapping[str, Any]) -> Json:
    """The session's fields completed by the facts; sensors by their names."""
    by_name = {sensor["name"]: sensor for sensor in facts.get("sensors", ())}
    merged = dict(session)
    for key, value in facts.items():
        if key == "sensors":
            merged[key] = [{**by_name.get(s.get("name"), {}), **s} for s in session.get(key) or facts[key]]
        elif isinstance(value, Mapping) and isinstance(session.get(key), Mapping):
            merged[key] = {**value, **{k: v for k, v in session[key].items() if v not in (None, "")}}
        else:
            merged.setdefault(key, value)
    return merged
