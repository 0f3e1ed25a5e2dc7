"""The fleet goes on being watched, whatever is broken on one unit or one stand; the faults are real broken records."""

import io
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import UTC, datetime
from threading import Event, Thread

import pytest
from sqlalchemy import text

from service.flags.records import Matter
from service.flags.store import FlagQuery, Flags
from service.kit.metrics import Metrics
from service.storage import Storage
from service.work.watch import Pace, look, watch_fleet
from tests.conftest import Filled
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.patience import LONG
from tests.service.dated import upload_and_date
from tests.service.kit.test_log import lines
from tests.service.made_sessions import session_bytes
from tests.service.stands.test_stands import measure

LATE = datetime(2029, 1, 1, tzinfo=UTC)
"""Every unit of these tests is overdue by then."""


def spoil(storage: Storage, statement: str, **values: str) -> None:
    with storage.database.engine.begin() as connection:
        connection.execute(text(statement), values)


def flagged(storage: Storage, matter: Matter) -> set[tuple[str, str]]:
    with storage.database.reading() as store:
        return {(f.unit, f.place) for f in Flags(store).page(FlagQuery()) if f.matter is matter}


@contextmanager
def watched(storage: Storage, metrics: Metrics) -> Iterator[tuple[Thread, Event]]:
    """The thread that watches the fleet without a pause, and what tells that it has looked twice."""
    stop, twice, seen = Event(), Event(), list[datetime]()

    def clock() -> datetime:
        seen.append(LATE)
        if len(seen) > 4:
            twice.set()
        return LATE

    thread = Thread(target=watch_fleet, args=(storage, clock, metrics, stop, Pace(0.0, 0.0, 0.0)), daemon=True)
    thread.start()
    yield thread, twice
    stop.set()
    thread.join(LONG)


def fill(storage: Storage) -> None:
    for number in range(2):
        upload_and_date(storage, session_bytes(unit=f"BA-{number}", seed=number), "a.json", LATE)


@pytest.fixture
def two_units(filled: Filled) -> Storage:
    return filled(fill)


def test_a_unit_whose_outlook_is_damaged_does_not_end_the_watch(two_units: Storage) -> None:
    spoil(two_units, "UPDATE outlooks SET document = '{}' WHERE unit_id = (SELECT min(id) FROM units)")
    metrics = Metrics()
    with watched(two_units, metrics) as (thread, twice):
        assert twice.wait(LONG)
        assert thread.is_alive()
        assert flagged(two_units, Matter.OVERDUE) == {("BA-1", "")}
    assert b'imu_health_background_faults_total{fault="KeyError",work="due dates"}' in metrics.text()


def test_a_fault_is_logged_with_what_was_done_and_where(two_units: Storage, written: io.StringIO) -> None:
    spoil(two_units, "UPDATE outlooks SET document = '{}' WHERE unit_id = (SELECT min(id) FROM units)")
    assert not look(two_units, lambda: LATE, Metrics())
    failed = [line for line in lines(written) if line["event"] == "background work failed"]
    assert {(line["doing"], line["place"]) for line in failed} == {("outlooks", "BA-0"), ("due dates", "BA-0")}
    assert all("Traceback" in line["exception"] for line in failed)


@pytest.mark.slow
@pytest.mark.parametrize(("column", "broken"), [("value", "7"), ("covariance", '[["x"], [2.0], [null]]')])
def test_a_stand_is_watched_although_a_motion_on_another_is_damaged(storage: Storage, column: str, broken: str) -> None:
    for number in range(4):
        measure(storage, number)
    spoil(
        storage,
        f"UPDATE common_motions SET {column} = :broken WHERE session_id ="
        " (SELECT max(s.id) FROM sessions s JOIN stands t ON t.id = s.stand_id"
        " WHERE t.name = 'S1' AND s.id IN (SELECT session_id FROM common_motions))",
        broken=broken,
    )
    metrics = Metrics()
    assert not look(storage, lambda: LATE, metrics)
    assert flagged(storage, Matter.SHIFTED) == {("BA-0", "S2")}
    assert b'imu_health_background_faults_total{fault="ServiceError",work="stands"} 1.0' in metrics.text()


def test_a_table_that_is_gone_is_told_and_the_due_dates_are_looked_at(two_units: Storage) -> None:
    spoil(two_units, "ALTER TABLE common_motions RENAME TO gone")
    assert not look(two_units, lambda: LATE, Metrics())
    assert len(flagged(two_units, Matter.OVERDUE)) == 2


@pytest.mark.parametrize(("failures", "pause"), [(0, 3600), (1, 60), (3, 240), (100, 3600)])
def test_after_failures_it_is_tried_again_sooner_and_then_ever_later(failures: int, pause: float) -> None:
    assert Pace().after(failures) == pause


def test_a_fleet_without_a_fault_is_looked_at_without_one(two_units: Storage) -> None:

    assert look(two_units, lambda: LATE, Metrics())
