"""Tests in database and files whether a service lost nothing and holds nothing by halves."""

from collections.abc import Collection, Iterator
from hashlib import sha256
from typing import Any

from sqlalchemy import Connection, func, select

from service.fleet.tables import ConditionRow
from service.opening import open_database
from service.sessions.tables import CalibrationRow, DecisionRow, ParameterRow, SessionRow
from service.settings import Settings
from service.storage.audit import AuditRow
from tests.service.storage.whole import files

SENSORS = 4
"""Sensors of the sessions that are checked: the fewest that say enough, so that much is uploaded."""
WHOLE: dict[Any, int] = {CalibrationRow: 1, ParameterRow: 4 * SENSORS, DecisionRow: 4 * SENSORS}
"""Rows that such a session of `session_bytes` has: one calibration, and four parameters a sensor."""


def faults(settings: Settings, acknowledged: Collection[bytes], sent: Collection[bytes]) -> list[str]:
    """Faults in the stored data after an interruption; none is wanted.

    ``acknowledged`` are uploads whose answer was seen, ``sent`` all that were ever sent.
    """
    database = open_database(settings.database)
    with database.engine.connect() as connection:
        found = list(_faults(connection, settings, acknowledged, sent))
    database.close()
    return found


def _faults(
    connection: Connection, settings: Settings, acknowledged: Collection[bytes], sent: Collection[bytes]
) -> Iterator[str]:
    stored = list(connection.execute(select(SessionRow.id, SessionRow.sha256, SessionRow.unit_id)))
    kept, hashes = files(settings.files), [row.sha256 for row in stored]
    promised, known = ({sha256(content).hexdigest() for content in group} for group in (acknowledged, sent))
    yield from (f"lost: {digest}" for digest in promised - set(hashes))
    yield from (f"twice: {digest}" for digest in set(hashes) if hashes.count(digest) > 1)
    yield from (f"from nowhere: {digest}" for digest in set(hashes) - known)
    for digest in hashes:
        if sha256(kept.get(digest, b"")).hexdigest() != digest:
            yield f"without its file: {digest}"
    yield from (
        f"damaged file: {name}"
        for name, content in kept.items()
        if not name.startswith(".") and sha256(content).hexdigest() != name
    )
    for row in stored:
        yield from _halves(connection, row.id)
    units = set(connection.scalars(select(ConditionRow.unit_id)))
    yield from (f"unit without its line: {row.unit_id}" for row in stored if row.unit_id not in units)


def _halves(connection: Connection, id: str) -> Iterator[str]:
    """Parts of one session that are missing, or there twice."""
    for table, wanted in WHOLE.items():
        rows = connection.scalar(select(func.count()).select_from(table).where(table.session_id == id))
        if rows != wanted:
            yield f"{rows} rows of {table.__tablename__} in place of {wanted}: {id}"
    told = select(func.count()).select_from(AuditRow).where(AuditRow.subject == id, AuditRow.action == "upload")
    if (times := connection.scalar(told)) != 1:
        yield f"{times} uploads in the audit: {id}"
