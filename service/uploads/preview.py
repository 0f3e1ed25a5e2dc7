"""A table of one's own layout before anything is stored: how it is understood, what is missing, and its first rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from estimator.errors import Problem, SessionError
from estimator.message import say
from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.writing import session_document
from service.errors import NotFoundError, RefusedError
from service.ingest import look_at, read_upload
from service.ingest.layout.envelope import wrapped
from service.ingest.layout.look import fingerprint
from service.ingest.layout.mapping import ASKED_ANEW, FORMAT, layout_of
from service.ingest.layout.understand import Seen, understood
from service.ingest.layout.vocabulary import plain_label
from service.planning.pattern import earlier
from service.storage import Storage
from service.types.store import UnitTypes
from service.units.store import Units
from service.uploads.store import Layouts

KNOWN = "This is a session file: upload it as it is, without a mapping."
FIRST_ROWS = 6
"""Of the table, as they will be read."""
OF_A_LOG = ("unit", "started_at", "notes", "sample_rate_hz")
NO_STAND = {"id": ""}
"""Of which nothing is known."""


@dataclass(frozen=True)
class Preview:
    """What is known of a table under a mapping."""

    mapping: dict[str, Any]
    """Complete: how the file is taken apart is stated too."""
    fingerprint: str
    """Of the headings."""
    remembered: bool
    """Whether the mapping is that of an earlier file."""
    seen: dict[str, Any]
    """The first look: headings, cells, sheets."""
    session: CalibrationSession | None
    """As it would be stored; None while something is missing."""
    problems: tuple[Problem, ...]


def preview(
    storage: Storage, content: bytes, filename: str, *, mapping: Mapping[str, Any] | None, unit: str, unit_type: str
) -> Preview:
    """How a table is, or would be, read; RefusedError where it is no table or the mapping is none."""
    try:
        seen = look_at(content if mapping is None else wrapped(mapping, content), filename)
        if seen["session"]:
            raise RefusedError(KNOWN, (Problem("file", KNOWN),))
        is_remembered = False
        if mapping is None:
            mapping, is_remembered = _proposed(storage, seen, unit, unit_type)
        whole = {**mapping, "format": FORMAT, "table": dict(seen["taken"]), "columns": _for(seen, mapping)}
        layout_of(whole, filename)
    except SessionError as fault:
        raise RefusedError(
            say("{filename} cannot be read as a table. Nothing was stored.", filename=filename), fault.problems
        ) from fault
    session, problems = _tried(whole, content, filename)
    return Preview(whole, fingerprint(seen), is_remembered, seen, session, problems)


def _proposed(storage: Storage, seen: Mapping[str, Any], unit: str, unit_type: str) -> tuple[dict[str, Any], bool]:
    """By the last file of this layout, and by the last session of the unit or its type."""
    with storage.database.reading() as store:
        if unit and not unit_type and Units(store).exists(unit):
            unit_type = UnitTypes(store).of_unit(unit).name
        known = Layouts(store).find(fingerprint(seen), unit_type)
    if known is not None:
        facts = known["session"] if not unit else facts_of(storage, unit, unit_type) or known["session"]
        return {**known, "session": _said({**facts, **_of_this(seen)}, unit)}, True
    facts = facts_of(storage, unit, unit_type)
    columns = understood([Seen(**column) for column in seen["columns"]], facts.get("sensors", ()))
    known = {**facts, **seen["facts"]} or _unknown(columns)
    return {"columns": columns, "session": _said(known, unit)}, False


def _of_this(seen: Mapping[str, Any]) -> dict[str, Any]:
    """What a log says of itself, which another of the same layout says otherwise."""
    return {key: value for key, value in seen["facts"].items() if key in OF_A_LOG}


def _said(facts: Mapping[str, Any], unit: str) -> dict[str, Any]:
    """With the unit that was named, or else the one that the file names."""
    return {**facts, "unit": unit or facts.get("unit", "")}


def facts_of(storage: Storage, unit: str, unit_type: str) -> dict[str, Any]:
    """Everything that the last session of the unit or the type says and the next will say too; else nothing."""
    try:
        like = earlier(storage, unit, unit_type)
    except NotFoundError:
        like = None
    if like is None:
        return {}
    document = session_document(like)
    return {key: value for key, value in document.items() if key not in ("format", "table", *ASKED_ANEW)}


def _unknown(columns: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The sensors that the headings name, of a block of which nothing else is known."""
    named = [column for column in columns if column["as"] and is_sensor(column["as"])]
    gyros = sum(str(column["as"]).startswith("G") for column in named)
    return {
        "block": "gyroscope" if 2 * gyros > len(named) else ACCELEROMETER,
        "programme": "two-axis-stand",
        "stand": NO_STAND,
        "sensors": [{"name": column["as"], "reading_unit": plain_label(column.get("unit", ""))} for column in named],
    }


def is_sensor(meaning: str) -> bool:
    """Whether a column is read as a sensor: those of a session and standard errors are in small letters."""
    return bool(meaning) and meaning != meaning.lower() and not meaning.endswith("_se")


def _for(seen: Mapping[str, Any], mapping: Mapping[str, Any]) -> list[Any]:
    """The mapping's columns where they are those of the file; else understood anew, as in another sheet."""
    given = mapping.get("columns", [])
    if [column["heading"] for column in seen["columns"]] == [c.get("heading") for c in given if isinstance(c, Mapping)]:
        return list(given)
    sensors = mapping.get("session", {}).get("sensors", ())
    named = [sensor for sensor in sensors if isinstance(sensor, Mapping)]
    return understood([Seen(**column) for column in seen["columns"]], named)


def _tried(
    mapping: Mapping[str, Any], content: bytes, filename: str
) -> tuple[CalibrationSession | None, tuple[Problem, ...]]:
    try:
        return read_upload(wrapped(mapping, content), filename), ()
    except SessionError as fault:
        return None, fault.problems


def first_rows(session: CalibrationSession) -> list[dict[str, Any]]:
    """The first rows as they will be stored, SI: angles in rad, what every sensor feels in m/s² or rad/s."""
    count_time = session.count_time or 1.0
    offset = np.array([sensor.nominal_offset or 0.0 for sensor in session.sensors])
    scale = np.array([sensor.nominal_scale for sensor in session.sensors])
    inputs = (session.readings[:FIRST_ROWS] - offset) / (scale * count_time)
    rows: list[dict[str, Any]] = []
    for j, felt in enumerate(inputs):
        row: dict[str, Any] = {} if session.flipped is None else {"run": "flipped" if session.flipped[j] else "direct"}
        for name, column in (
            ("beta_rad", session.beta),
            ("time_s", session.time),
            ("temperature_c", session.temperature),
        ):
            row |= {} if column is None else {name: float(column[j])}
        row |= {sensor.name: float(value) for sensor, value in zip(session.sensors, felt, strict=True)}
        rows.append(row)
    return rows


def felt_length(session: CalibrationSession) -> float | None:
    """Length of the vector that the first row gives with the nominal axes, m/s² (rad/s): about 9.8 at rest."""
    places = [i for i, sensor in enumerate(session.sensors) if sensor.kind == session.block]
    axes = np.array([session.sensors[i].nominal_axis for i in places])
    row = first_rows(session)[0]
    felt = np.array([row[session.sensors[i].name] for i in places])
    return float(np.linalg.norm(np.linalg.lstsq(axes, felt, rcond=None)[0]))
