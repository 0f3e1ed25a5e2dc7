"""A fleet's sessions computed again: nothing is done twice, no failure stops another, and a killed worker costs
nothing."""

import os
import signal
from collections.abc import Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import psutil
import pytest

from service.errors import ConflictError, ServiceError
from service.models.records import ModelRevision, Scope
from service.models.store import Models
from service.records import many as recalibrating
from service.records import many as workers
from service.records.many import by_workers, one_by_one, units_behind
from service.sessions.calibrations_store import Calibrations
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.storage.audit import Audit
from service.uploads.receive import upload
from tests.builders import accelerometer_block
from tests.databases import Databases, one_engine
from tests.service.ingest.test_formats import parquet_bytes
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNITS = tuple(f"BA-{number:03}" for number in range(4))
TYPE = "redundant block"


def clock() -> datetime:
    return NOW


def fill(storage: Storage, *units: str, more: tuple[bytes, ...] = ()) -> list[str]:
    """A session of every unit, and a cause accepted for their type since; the ids."""
    contents = [*more, *(session_bytes(unit=unit, unit_type=TYPE, notes=unit) for unit in units)]
    ids = [upload(storage, content, "a.json", NOW).id for content in contents]
    accept(storage, ids[0])
    return ids


def accept(storage: Storage, session: str, scope: Scope = Scope.UNIT_TYPE, subject: str = TYPE) -> None:
    new = ModelRevision(0, scope, subject, "cubic-nonlinearity", ("A1",), session, None, "K. Ito", "", NOW)
    with storage.database.writing() as store:
        Models(store).add(new)


def revisions(storage: Storage, ids: list[str]) -> set[tuple[int, ...]]:
    """Revisions that sessions were computed under."""
    with storage.database.reading() as store:
        return {Calibrations(store).revisions(id) for id in ids}


def test_only_units_that_a_later_model_concerns_are_behind(storage: Storage) -> None:
    first, _ = fill(storage, *UNITS[:2])
    assert tuple(units_behind(storage)) == UNITS[:2]
    assert [one.done.recomputed for one in one_by_one(storage, clock, 2.0)(units_behind(storage)) if one.done] == [1, 1]
    assert tuple(units_behind(storage)) == ()
    accept(storage, first, Scope.UNIT, UNITS[0])
    with storage.database.reading() as store:
        assert (Models(store).units_behind("", 9), Models(store).units_behind(UNITS[0], 9)) == (UNITS[:1], ())
        assert Models(store).count_behind() == 1


@one_engine
def test_a_session_whose_file_is_lost_is_told_and_stops_no_other(storage: Storage) -> None:
    lost, found = fill(storage, *UNITS[:2])
    with storage.database.reading() as store:
        storage.files.path(Sessions(store).get(lost).sha256).unlink()
    first, second = one_by_one(storage, clock, 2.0)(units_behind(storage))
    assert first.done is not None
    assert [(one.session, "missing" in one.why) for one in first.done.kept] == [(lost, True)]
    assert second.done is not None
    assert (second.done.recomputed, revisions(storage, [found])) == (1, {(0, 1)})


@one_engine
def test_a_unit_that_is_not_there_is_told_and_stops_no_other(storage: Storage) -> None:
    fill(storage, *UNITS[:1])
    first, second = one_by_one(storage, clock, 2.0)(("none", *UNITS[:1]))
    assert first.failure is not None
    assert "There is no unit 'none'" in first.failure.reason
    assert second.done is not None


@pytest.mark.slow
@pytest.mark.parametrize("databases", ["postgresql"], indirect=True)
def test_a_worker_that_is_killed_costs_nothing(storage: Storage, settings: Settings) -> None:
    binary = parquet_bytes(accelerometer_block(unit="BB-001", positions=12) | {"unit_type": TYPE})
    ids = fill(storage, *UNITS, more=(binary,))
    killed: list[int] = []
    with by_workers(storage, settings, clock, workers=2) as run:
        outcomes: list[Any] = []
        for outcome in run(units_behind(storage)):
            if not outcomes:
                killed.append(kill_one_worker())
            outcomes.append(outcome)
    assert [one.failure for one in outcomes if one.failure] == []
    assert (len(killed), len(outcomes)) == (1, len(ids))
    assert revisions(storage, ids) == {(0, 1)}
    assert tuple(units_behind(storage)) == ()


def kill_one_worker() -> int:
    """Kills a worker, as happens when the machine has no memory left; both are at a unit."""
    children = psutil.Process().children(recursive=True)
    own = [child for child in children if "spawn_main" in " ".join(child.cmdline())]
    os.kill(own[-1].pid, signal.SIGKILL)
    return own[-1].pid


@one_engine
def test_workers_keep_no_profile_which_would_grow_for_an_hour(settings: Settings) -> None:
    with workers.local_cluster(settings, 1) as client:
        (callbacks,) = client.run(lambda dask_worker: list(dask_worker.periodic_callbacks)).values()
    assert "heartbeat" in callbacks
    assert not [name for name in callbacks if name.startswith("profile")]


@pytest.fixture
def elsewhere(sqlite: Databases, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """This process as a worker with another database."""
    monkeypatch.setenv("IMU_HEALTH_DATABASE_URL", sqlite.migrated())
    monkeypatch.setenv("IMU_HEALTH_DATA_FOLDER", str(tmp_path))
    yield
    workers._own.cache_clear()


@one_engine
@pytest.mark.usefixtures("elsewhere")
def test_a_worker_with_another_database_computes_nothing(storage: Storage) -> None:
    fill(storage, *UNITS[:1])
    with storage.database.reading() as store:
        last = Audit(store).last()
    with pytest.raises(ConflictError, match="IMU_HEALTH_DATABASE_URL"):
        workers._work(last, UNITS[0], NOW)


@one_engine
def test_without_its_library_several_processes_are_refused_in_words(
    storage: Storage, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recalibrating, "ROOM", "service.work.workers_of_nobody")
    with pytest.raises(ServiceError, match=r"pip install 'imu-health\[dask\]'"):
        by_workers(storage, settings, clock, workers=2)


@one_engine
def test_a_scheduler_that_does_not_answer_is_refused_in_words(
    storage: Storage, settings: Settings, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(workers, "PATIENCE", "0.3s")
    own = by_workers(storage, settings, clock, workers=1, scheduler="tcp://127.0.0.1:9")
    with pytest.raises(ServiceError, match=r"scheduler tcp://127\.0\.0\.1:9 cannot be used"), own:
        pass
