"""A fleet of any size: a few units with all their sessions come in by the front door, and are then multiplied within
the database, row by row, under serial numbers, hashes and keys of their own.

What is multiplied is what pages read: units, sessions, parameters, decisions, common motions, flags with their lives,
conditions, outlooks and what histories tell, and the diagnosis of every unit's latest session. The documents of
calibrations, the statistics of groups and the files stay single: no page of the fleet reads them.
"""

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from sqlalchemy import Connection, inspect, text

from service.records.diagnose import diagnose
from service.records.follow import refresh_beside
from service.storage import Storage
from service.storage.engine import open_engine
from service.storage.waits import PATIENT
from service.uploads.receive import upload
from tests.builders import accelerometer_block, true_sensors

TEMPLATES = 10
"""Units that come in by the front door: as many kinds of life as pages have to show."""
STANDS = ("ODG-1", "ODG-2", "ODG-3")
START = datetime(2021, 1, 4, 9, tzinfo=UTC)
NOW = datetime(2026, 6, 1, 12, tzinfo=UTC)
"""Time at which the pages are looked at."""
MICRO_G = 9.80665e-6
AWAY = {"unit": 100_000, "flag": 1_000_000}
"""Distance between the keys of a unit and of its copy: more than there are templates."""
COPIED = (
    "units", "sessions", "parameters", "decisions", "common_motions", "diagnoses", "conditions", "outlooks",
    "histories", "flags", "notices",
)  # fmt: skip
"""Tables that are copied, in an order that foreign keys allow."""
HASH = "md5({0} || '/' || n) || md5(n || '/' || {0})"
SERIAL = "serial || '-' || lpad(n::text, 5, '0')"
KEY = "substr(md5({0} || '/' || n), 1, 20)"
UNIT, FLAG = f"{{0}} + n * {AWAY['unit']}", f"{{0}} + n * {AWAY['flag']}"
CHANGED = {
    "serial": SERIAL, "unit_id": UNIT, "units.id": UNIT, "sha256": HASH, "content_digest": HASH,
    "sessions.id": KEY, "session_id": KEY, "last_session": KEY, "flags.id": FLAG, "notices.id": FLAG, "flag_id": FLAG,
    "document": "replace({0}::text, (SELECT serial FROM units u WHERE u.id = unit_id),"
    " (SELECT serial FROM units u WHERE u.id = unit_id) || '-' || lpad(n::text, 5, '0'))::json",
}  # fmt: skip
"""Expressions for the columns of a copy that differ from the original, for one table or for all."""


@dataclass(frozen=True)
class Size:
    """Size of a fleet."""

    units: int
    sessions: int
    """Sessions of every unit."""


def fill(storage: Storage, size: Size) -> None:
    """Templates, and their copies; PostgreSQL."""
    for number in range(TEMPLATES):
        live(storage, number, size.sessions)
    multiply(storage, size.units // TEMPLATES)


def live(storage: Storage, number: int, sessions: int) -> str:
    """All sessions of one unit by the front door, the latest diagnosed; returns its identifier."""
    last = ""
    for at, content in _life(number, sessions):
        last = upload(storage, content, "session.json", at).id
    refresh_beside(storage, serial(number), NOW)
    diagnose(storage, last, NOW, 2.0)
    return last


def serial(number: int) -> str:
    return f"BA-{number:03d}"


def _life(number: int, sessions: int) -> Iterator[tuple[datetime, bytes]]:
    """Sessions of one unit, spread over five years; biases of some drift, some steadily out of tolerance."""
    rng = np.random.default_rng(number)
    rates = rng.normal(0.0, 4.0, 6) + (12.0 if number == 3 else 0.0)
    every = timedelta(days=5 * 365 / sessions)
    for k in range(sessions):
        sensors = true_sensors(6, bias=1e-3, quadratic=1e-6, tilt=1e-4)
        years = k * every / timedelta(days=365)
        moved = [replace(s, bias=s.bias + MICRO_G * r * years) for s, r in zip(sensors, rates, strict=True)]
        document = accelerometer_block(6, seed=1000 * number + k, unit=serial(number), sensors=moved, positions=24)
        at = START + number * timedelta(hours=3) + k * every
        own = {"started_at": at.isoformat(), "stand": {**document.get("stand", {}), "id": STANDS[(number + k) % 3]}}
        yield at + timedelta(hours=1), json.dumps(document | own).encode()


def multiply(storage: Storage, times: int) -> None:
    """Every template so many times, itself among them."""
    patient = open_engine(storage.database.url, PATIENT)
    with patient.begin() as connection:
        connection.execute(text("SET LOCAL session_replication_role = replica"))  # keys are known to fit: no triggers
        for table in COPIED:
            connection.execute(text(_copying(connection, table)), {"times": times - 1})
    with patient.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("VACUUM ANALYZE"))
    patient.dispose()


def _copying(connection: Connection, table: str) -> str:
    """A statement that copies all rows of a table."""
    columns: list[Any] = [column["name"] for column in inspect(connection).get_columns(table)]
    made = ", ".join(_made(table, column) for column in columns)
    return f"INSERT INTO {table} ({', '.join(columns)}) SELECT {made} FROM {table}, generate_series(1, :times) AS n"


def _made(table: str, column: str) -> str:
    if column == "document" and table != "outlooks":
        return column
    return CHANGED.get(f"{table}.{column}", CHANGED.get(column, column)).format(column)
