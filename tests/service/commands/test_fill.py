"""`imu-health fill`: a large fleet of simulated units, through the same upload as a user's."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from service.demo.fill import plan
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.opening import open_database
from service.settings import Settings
from service.storage import Files, Storage
from tests.service.commands.conftest import Run


def test_a_fleet_is_the_same_for_the_same_seed_and_has_every_story() -> None:
    planned = plan(1000, 1)
    assert planned == plan(1000, 1) != plan(1000, 2)
    assert (len(planned.entries), len(planned.lives), len(planned.retired)) == (1000, 980, 20)
    shares = {story: sum(life.member.story == story for life in planned.lives) for story in ("stable", "drift", "new")}
    assert 600 < shares["stable"] < 780
    assert min(shares["drift"], shares["new"]) > 10
    assert planned.files == sum(life.member.sessions for life in planned.lives)


@pytest.fixture
def folder(run: Run, tmp_path: Path) -> Path:
    """A data folder with three units."""
    ran = run("fill", "--units", 3, "--data-folder", tmp_path / "data")
    assert ran.code == 0
    assert "3 simulated units" in ran.err
    assert "Done in" in ran.err
    return tmp_path / "data"


@pytest.mark.slow
def test_it_fills_an_empty_database_only(run: Run, folder: Path) -> None:
    again = run("fill", "--units", 3, "--data-folder", folder)
    assert (again.code, "empty database" in again.err) == (1, True)
    settings = Settings(data_folder=folder)
    storage = Storage(open_database(settings.database), Files(settings.files))
    with storage.database.reading() as store:
        units = Fleet(store).units(FleetQuery(retired=None))
        in_use = Fleet(store).condition().units
    storage.database.close()
    assert len(units) == 3
    assert in_use == 2
    assert all(unit.location and unit.simulated for unit in units)
    assert all(unit.last_at is not None and unit.last_at < datetime.now(UTC) for unit in units)
