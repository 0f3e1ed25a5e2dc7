"""Preview of a table of custom layout: its mapping, its missing facts, and its first rows."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from estimator.errors import Problem, SessionError
from estimator.json_object import Json
from estimator.message import say
from estimator.session import CalibrationSession
from estimator.writing import session_document
from service.errors import NotFoundError, RefusedError
from service.ingest import lines_of, look_at, read_first_rows, read_upload
from service.ingest.layout.facts import (
    Rows,
    completed,
    facts_seen,
    following_the_rate,
    is_contradicted,
    questions,
    started_at,
    with_unit_of_time,
)
from service.ingest.layout.mapping import FORMAT, PER_FILE_FIELDS, fingerprint, layout_of
from service.ingest.layout.understand import SeenColumn, understood, with_kinds
from service.planning.pattern import earlier
from service.planning.rules import SoFar, so_far
from service.storage import Storage
from service.types.store import UnitTypes
from service.units.store import Units
from service.uploads.store import Layouts

KNOWN = "This is a session file: upload it as it is, without a mapping."
FIRST_ROWS = 6
OF_A_LOG = ("unit", "started_at", "notes", "sample_rate_hz")


@dataclass(frozen=True)
class Preview:
    """A table under a mapping."""

    mapping: Json
    """Complete: with the settings of the parser."""
    fingerprint: str
    """Fingerprint of the headings."""
    remembered: bool
    """Whether the mapping is that of an earlier file."""
    seen: Json
    """Result of the first look: headings, cells, sheets."""
    session: CalibrationSession | None
    """Session as it would be stored; None while something is missing."""
    problems: tuple[Problem, ...]
    so_far: SoFar | None
    """Positions and parameters that are missing; None while it cannot be read so far."""


def preview(
    storage: Storage,
    content: bytes | Path,
    filename: str,
    *,
    mapping: Mapping[str, Any] | None,
    unit: str,
    unit_type: str,
) -> Preview:
    """Preview of a table; RefusedError for another file or an invalid mapping."""
    try:
        look, faults = _looked(content, filename, mapping)
        if look["session"]:
            raise RefusedError(KNOWN, (Problem("file", KNOWN),))
        is_remembered = False
        if mapping is None or _is_cut_anew(look, mapping):
            known = {} if mapping is None else mapping.get("session", {})
            mapping, is_remembered = ({}, False) if faults else _proposed(storage, look, unit, unit_type, filename)
            mapping = {**mapping, "session": {**mapping.get("session", {}), **known}}
        complete = {**mapping, "format": FORMAT, "table": dict(look["taken"]), "columns": _columns_for(look, mapping)}
        layout_of(complete, filename)
        rows = Rows(complete["columns"], _seen(look), look["rows"])
        complete["session"] = completed(complete.get("session", {}), rows)
    except SessionError as fault:
        raise RefusedError(
            say("{filename} cannot be read as a table. Nothing was stored.", filename=filename), fault.problems
        ) from fault
    if faults:
        return Preview(complete, fingerprint(look), False, look, None, faults, None)
    session, problems = _read(complete, content, filename, is_part=look["sampled"])
    asked = questions(complete["session"], rows)
    answered = {problem.field for problem in asked} | set(following_the_rate(complete["session"], rows))
    problems = (*asked, *(problem for problem in problems if problem.field not in answered))
    partly = session
    if session is None and not look["sampled"]:
        partly, _ = _read(complete, content, filename, is_part=True)
    found = None if partly is None else so_far(storage, partly)
    return Preview(complete, fingerprint(look), is_remembered, look, session, problems, found)


def _looked(
    content: bytes | Path, filename: str, mapping: Mapping[str, Any] | None
) -> tuple[Json, tuple[Problem, ...]]:
    """The preview of a table; of a text that cannot be cut its first lines, and why it cannot."""
    try:
        return look_at(content, filename, mapping), ()
    except SessionError as fault:
        try:
            return lines_of(content, filename, mapping), fault.problems
        except SessionError:
            raise fault from None


def _is_cut_anew(look: Mapping[str, Any], mapping: Mapping[str, Any]) -> bool:
    """Whether the mapping is one of settings alone, without any column or sensor yet."""
    return not mapping.get("columns") and not mapping.get("session", {}).get("sensors") and bool(look["columns"])


def _seen(look: Mapping[str, Any]) -> list[SeenColumn]:
    return [SeenColumn(**column) for column in look["columns"]]


def _proposed(storage: Storage, look: Mapping[str, Any], unit: str, unit_type: str, filename: str) -> tuple[Json, bool]:
    """The mapping of the last file with this layout, unless the values contradict it, or of the last session of the
    unit or its type."""
    seen = _seen(look)
    with storage.database.reading() as store:
        if unit and not unit_type and Units(store).exists(unit):
            unit_type = UnitTypes(store).of_unit(unit).name
        found = Layouts(store).find(fingerprint(look), unit_type)
    facts = facts_of(storage, unit, unit_type)
    if found is not None:
        rows, own = Rows(found["columns"], seen, look["rows"]), facts if unit else {}
        known = dict(own or found["session"])
        if known.get("sample_rate_hz") and (clock := rows.rate()) is not None:
            known["sample_rate_hz"] = clock
        if own or not is_contradicted(known, rows):
            return {**found, "session": _with_unit(_titled({**known, **_log_facts(look)}, look), unit)}, True
    guesses = with_kinds(seen, facts.get("sensors", ()), filename.rpartition(".")[0])
    rate = look["titles"].get("sample_rate_hz")
    columns = with_unit_of_time([guess.column for guess in guesses], seen, look["rows"], rate)
    guesses = [replace(guess, column=column) for guess, column in zip(guesses, columns, strict=True)]
    found = {**facts, **look["facts"]} or facts_seen(guesses, seen, look["rows"])
    found = {**started_at(columns, seen), **found}
    return {"columns": columns, "session": _with_unit(_titled(found, look), unit)}, False


def _titled(facts: Json, look: Mapping[str, Any]) -> Json:
    """The facts with what the rows above the table state; of another stand nothing else is known."""
    titles, known = dict(look["titles"]), facts.get("stand")
    if isinstance(known, Mapping) and known.get("id") == titles.get("stand", {}).get("id"):
        del titles["stand"]
    return {**facts, **titles}


def _log_facts(look: Mapping[str, Any]) -> Json:
    """Facts of a log that differ between logs of the same layout."""
    return {key: value for key, value in look["facts"].items() if key in OF_A_LOG}


def _with_unit(facts: Mapping[str, Any], unit: str) -> Json:
    """The facts with the given unit, or else that of the file."""
    return {**facts, "unit": unit or facts.get("unit", "")}


def facts_of(storage: Storage, unit: str, unit_type: str) -> Json:
    """Facts of the last session of the unit or type that also hold for the next; else none."""
    try:
        last = earlier(storage, unit, unit_type)
    except NotFoundError:
        last = None
    if last is None:
        return {}
    document = session_document(last)
    return {key: value for key, value in document.items() if key not in ("format", "table", *PER_FILE_FIELDS)}


def _columns_for(look: Mapping[str, Any], mapping: Mapping[str, Any]) -> list[Any]:
    """The mapping's columns where they match the file; else recognised anew, as for another sheet."""
    columns = mapping.get("columns", [])
    if [column["heading"] for column in look["columns"]] == [
        c.get("heading") for c in columns if isinstance(c, Mapping)
    ]:
        return list(columns)
    sensors = mapping.get("session", {}).get("sensors", ())
    sensors_known = [sensor for sensor in sensors if isinstance(sensor, Mapping)]
    return understood(_seen(look), sensors_known)


def _read(
    mapping: Mapping[str, Any], content: bytes | Path, filename: str, *, is_part: bool
) -> tuple[CalibrationSession | None, tuple[Problem, ...]]:
    try:
        return (read_first_rows if is_part else read_upload)(content, filename, mapping), ()
    except SessionError as fault:
        return None, fault.problems


def first_rows(session: CalibrationSession) -> list[Json]:
    """The first rows as they will be stored, SI: angles in rad, readings in m/s² or rad/s."""
    count_time = session.count_time or 1.0
    offset = np.array([sensor.nominal_offset or 0.0 for sensor in session.sensors])
    scale = np.array([sensor.nominal_scale for sensor in session.sensors])
    inputs = (session.readings[:FIRST_ROWS] - offset) / (scale * count_time)
    rows: list[Json] = []
    for j, inputs_of_row in enumerate(inputs):
        row: Json = {} if session.flipped is None else {"run": "flipped" if session.flipped[j] else "direct"}
        for name, column in (
            ("beta_rad", session.beta),
            ("time_s", session.time),
            ("temperature_c", session.temperature),
        ):
            row |= {} if column is None else {name: float(column[j])}
        row |= {sensor.name: float(value) for sensor, value in zip(session.sensors, inputs_of_row, strict=True)}
        rows.append(row)
    return rows


def felt_length(session: CalibrationSession) -> float | None:
    """Length of the vector of the first row with the nominal axes, m/s² (rad/s): about 9.8 at rest."""
    indices = [i for i, sensor in enumerate(session.sensors) if sensor.kind == session.block]
    axes = np.array([session.sensors[i].nominal_axis for i in indices])
    row = first_rows(session)[0]
    row_inputs = np.array([row[session.sensors[i].name] for i in indices])
    return float(np.linalg.norm(np.linalg.lstsq(axes, row_inputs, rcond=None)[0]))
