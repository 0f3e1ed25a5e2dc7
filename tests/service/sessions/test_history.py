"""Points that a unit's page draws: of its newest sessions, whole; and the content of its tables."""

from datetime import UTC, datetime

import pytest

from service.pages.unit import parameters
from service.papers.certified import recent_history
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import HistoryPoint
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from tests.builders import ARCSEC
from tests.conftest import Filled, Holding
from tests.service.made_sessions import session_bytes
from tests.service.stands.test_stands import measured_on

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
POINTS = 24
"""Points of one session with six sensors."""


def measure(storage: Storage) -> None:
    """A unit with three sessions, the latest uploaded first."""
    for month in (7, 3, 5):
        upload(storage, session_bytes(seed=month, month=month), "session.json", NOW)


@pytest.fixture
def measured(filled: Filled) -> Storage:
    return filled(measure)


@pytest.mark.parametrize(("most", "months"), [(3 * POINTS, [3, 5, 7]), (3 * POINTS - 1, [5, 7]), (POINTS, [7])])
def test_the_newest_sessions_that_fit_are_taken_whole(measured: Storage, most: int, months: list[int]) -> None:
    with measured.database.reading() as store:
        found = recent_history(store, "BA-017", most, HistoryQuery())
    assert [point.at.month for point in found] == [month for month in months for _ in range(POINTS)]


def test_the_latest_of_every_parameter_is_the_end_of_its_history(measured: Storage) -> None:
    with measured.database.reading() as store:
        found = History(store).latest(Units(store).key("BA-017"))
        every = recent_history(store, "BA-017", 1000, HistoryQuery())
    last = {(point.sensor, point.parameter): point for point in every}
    assert {point.at.month for point in found} == {7}
    assert sorted(found, key=str) == sorted(last.values(), key=str)


def axis_of(storage: Storage, *, raw: bool) -> list[HistoryPoint]:
    with storage.database.reading() as store:
        return list(recent_history(store, "BA-1", 1000, HistoryQuery(parameter="axis", sensor="A1", raw=raw)))


def test_an_axis_is_shown_as_it_is_judged_and_as_it_was_measured_on_demand(storage: Storage) -> None:
    """A block that turned by 15 arcsec between two sessions."""
    for month, seed in ((3, 1), (7, 2)):
        upload(storage, measured_on("S2", "BA-1", month, seed), "a.json", NOW)
    judged, measured = (axis_of(storage, raw=raw)[-1] for raw in (False, True))
    assert (judged.value or 0) / ARCSEC < 3 < 8 < (measured.value or 0) / ARCSEC
    assert (judged.value, measured.value) == (judged.deviation, measured.deviation)
    assert (judged.expanded or 0) < (measured.expanded or 0)
    assert judged.verdict is measured.verdict


def test_a_table_holds_the_newest_sessions_and_says_where_the_others_are(
    holding: Holding, monkeypatch: pytest.MonkeyPatch
) -> None:
    service = holding(session_bytes(month=1), session_bytes(seed=2, month=2))

    def found() -> tuple[int, int]:
        page = service.get("/units/BA-017/parameters/bias-accelerometer", headers={"Accept": "text/html"}).text
        return page.count('<tr><th scope="row"><a href="/sessions/'), page.count("Earlier sessions: <a")

    assert found() == (2, 0)
    monkeypatch.setattr(parameters, "LISTED", 1)
    assert found() == (1, 1)
