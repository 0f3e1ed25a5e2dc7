"""A large fleet of simulated units, through the same upload as a user's."""

from datetime import UTC, datetime

import pytest

from benchmarks.large_fleet import fill_many, plan
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.settings import Settings
from service.storage import Storage


def test_a_fleet_is_the_same_for_the_same_seed_and_has_every_story() -> None:
    planned = plan(1000, 1)
    assert planned == plan(1000, 1) != plan(1000, 2)
    assert (len(planned.entries), len(planned.lives), len(planned.retired)) == (1000, 980, 20)
    shares = {story: sum(life.member.story == story for life in planned.lives) for story in ("stable", "drift", "new")}
    assert 600 < shares["stable"] < 780
    assert min(shares["drift"], shares["new"]) > 10
    assert planned.files == sum(life.member.sessions for life in planned.lives)


@pytest.mark.slow
def test_it_fills_a_database_with_units_in_use_and_retired_ones(settings: Settings, storage: Storage) -> None:
    assert sum(fill_many(settings, plan(3, 1), datetime.now(UTC), 1)) == plan(3, 1).files
    with storage.database.reading() as store:
        units = Fleet(store).units(FleetQuery(retired=None))
        in_use = Fleet(store).condition().units
    assert len(units) == 3
    assert in_use == 2
    assert all(unit.location and unit.simulated for unit in units)
    assert all(unit.last_at is not None and unit.last_at < datetime.now(UTC) for unit in units)
