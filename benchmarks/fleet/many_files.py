"""Many sessions with files of their own: a few units come in by the front door, and are multiplied under other serial
numbers, in the database and on disk, so that each can be computed again from its file."""

import json
from datetime import UTC, datetime, timedelta
from hashlib import sha256

from sqlalchemy import Connection, inspect, text

from service.sessions.records import ID_DIGITS
from service.storage import Storage
from service.storage.engine import open_engine
from service.storage.waits import PATIENT
from service.uploads.receive import upload
from tests.builders import accelerometer_block

TEMPLATES, SESSIONS = 10, 10
"""Units that come in by the front door, and sessions of every unit."""
TYPE = "redundant block"
START = datetime(2021, 1, 4, 9, tzinfo=UTC)
NOW = datetime(2026, 6, 1, 12, tzinfo=UTC)
AWAY = 100_000
"""Distance between the keys of a unit and of its copy: more than there are templates."""
COPIED = ("units", "sessions", "calibrations", "parameters", "decisions", "common_motions", "conditions")
"""Tables that recomputation reads or writes, in an order that foreign keys allow."""
ID = "(SELECT c.id FROM copied c WHERE c.old = {0} AND c.n = copies.n)"
CHANGED = {
    "serial": "serial || '-' || n", "unit_id": f"unit_id + n * {AWAY}", "units.id": f"id + n * {AWAY}",
    "sessions.id": ID, "session_id": ID, "last_session": ID, "content_digest": "md5(content_digest || n)",
    "sha256": "(SELECT c.sha256 FROM copied c WHERE c.old = sessions.id AND c.n = copies.n)",
}  # fmt: skip
"""Expressions for the columns of a copy that differ from the original."""


def fill(storage: Storage, units: int) -> None:
    """Fills the storage with so many units, ten at least."""
    for unit in range(TEMPLATES):
        for number in range(SESSIONS):
            content = _content(f"BA-{unit:03}", number)
            upload(storage, content, "session.json", NOW, is_dated_later=True, outlook=number == SESSIONS - 1)
    times = max(units // TEMPLATES, 1) - 1
    patient = open_engine(storage.database.url, PATIENT)
    with patient.begin() as connection:
        _copy_files(storage, connection, times)
        for table in COPIED:
            connection.execute(text(_copying(connection, table)), {"times": times})
    with patient.connect().execution_options(isolation_level="AUTOCOMMIT") as connection:
        connection.execute(text("VACUUM ANALYZE"))
    patient.dispose()


def _content(unit: str, number: int) -> bytes:
    document = accelerometer_block(6, seed=number, unit=unit, positions=24)
    own = {"started_at": (START + number * timedelta(days=150)).isoformat(), "unit_type": TYPE}
    return json.dumps(document | own).encode()


def _copy_files(storage: Storage, connection: Connection, times: int) -> None:
    """Stores copies of the files under other serial numbers, each with a hash of its own, and lists them in a table."""
    connection.execute(
        text("CREATE TEMPORARY TABLE copied (old text, n int, id text, sha256 text, PRIMARY KEY (old, n))")
    )
    found = connection.execute(text("SELECT s.id, s.sha256, u.serial FROM sessions s JOIN units u ON u.id = s.unit_id"))
    for old, digest, serial in found.all():
        content, rows = storage.files.read(digest), []
        for n in range(1, times + 1):
            own = content.replace(json.dumps(serial).encode(), json.dumps(f"{serial}-{n}").encode())
            name = sha256(own).hexdigest()
            path = storage.files.path(name)
            path.parent.mkdir(exist_ok=True)
            path.write_bytes(own)
            rows.append({"old": old, "n": n, "id": name[:ID_DIGITS], "sha256": name})
        if rows:
            connection.execute(text("INSERT INTO copied VALUES (:old, :n, :id, :sha256)"), rows)


def _copying(connection: Connection, table: str) -> str:
    """A statement that copies all rows of a table."""
    columns = [column["name"] for column in inspect(connection).get_columns(table)]
    made = [CHANGED.get(f"{table}.{c}", CHANGED.get(c, f"{table}.{c}")).format(f"{table}.{c}") for c in columns]
    own = f"SELECT {', '.join(made)} FROM {table}, generate_series(1, :times) AS copies (n)"
    return f"INSERT INTO {table} ({', '.join(columns)}) {own}"
