"""What a unit's page draws: its newest sessions, whole."""

from datetime import UTC, datetime

import pytest

from service.flows.receive import upload
from service.storage import Storage
from service.views.history import recent_history
from tests.service.sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
POINTS = 24
"""Of one session with six sensors."""


@pytest.fixture
def measured(storage: Storage) -> Storage:
    """A unit with three sessions, the latest uploaded first."""
    for month in (7, 3, 5):
        upload(storage, session_bytes(seed=month, month=month), "session.json", NOW)
    return storage


@pytest.mark.parametrize(("most", "months"), [(3 * POINTS, [3, 5, 7]), (3 * POINTS - 1, [5, 7]), (POINTS, [7])])
def test_the_newest_sessions_that_fit_are_taken_whole(measured: Storage, most: int, months: list[int]) -> None:
    with measured.database.reading() as store:
        found = recent_history(store, "BA-017", most)
    assert [point.at.month for point in found] == [month for month in months for _ in range(POINTS)]
