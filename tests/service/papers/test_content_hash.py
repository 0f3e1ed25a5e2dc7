"""A certificate's content hash is that of what it states, in whatever order, and whenever, its records came."""

from datetime import UTC, datetime, timedelta

import pytest

from service.papers.certified import certified_session, laboratory_of
from service.papers.desk import statement_of
from service.records.changes import record_service
from service.records.diagnose import diagnose
from service.settings import Settings
from service.storage import Storage
from service.units.records import NewService
from service.uploads.receive import upload
from tests.conftest import Filled
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes, session_id

UNIT = "BA-017"
SESSIONS = tuple(session_bytes(seed=month, month=month, a3_moved=10.0 * month) for month in (1, 2, 3))
REPAIR = NewService("repair", datetime(2026, 1, 15, tzinfo=UTC), "", "K. Ito")
NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def content_hash(storage: Storage, order: tuple[int, ...]) -> str:
    """Hash of the latest session's certificate, once records came hour by hour; the last number is the service's."""
    for hour, number in enumerate(order):
        now = NOW + timedelta(hours=hour)
        if number == len(SESSIONS):
            record_service(storage, UNIT, REPAIR, now)
        else:
            upload(storage, SESSIONS[number], "a.json", now)
    made = diagnose(storage, session_id(SESSIONS[-1]), NOW + timedelta(days=1))
    return statement_of(certified_session(storage, made, laboratory_of(Settings()))).content_hash


@pytest.mark.slow
@one_engine
def test_it_is_the_same_in_every_order(filled: Filled) -> None:
    orders = ((0, 1, 2, 3), (2, 1, 0, 3), (1, 3, 2, 0))
    assert len({content_hash(filled(lambda _: None), order) for order in orders}) == 1
