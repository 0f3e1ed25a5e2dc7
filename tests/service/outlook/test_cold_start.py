"""A unit measured just after switching on, with warm sessions behind it: settling is no drift of its sensors."""

import json
from datetime import UTC, datetime
from functools import cache

import numpy as np

from service.flags.records import Matter
from service.flags.store import FlagQuery, Flags
from service.outlook.changes import known_of
from service.outlook.reading import outlook_of
from service.records.diagnose import diagnose
from service.storage import Storage
from service.uploads.receive import upload
from tests.blind.courses import BLOCKS, COLD, Life, draw_life
from tests.databases import one_engine
from tests.service.dated import upload_and_date

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
EARLIER, AT = 5, 3
"""Warm sessions, one a month, and after how many of them the other comes."""


@cache
def life() -> Life:
    return draw_life(BLOCKS[0], COLD, 20.0, np.random.default_rng((62, 1)), earlier=EARLIER)


def measured(storage: Storage) -> tuple[str, str]:
    """The unit, and the session just after switching on between warm ones, not diagnosed yet."""
    *warm, cold = life().sessions
    for document in warm:
        upload(storage, json.dumps(document).encode(), "a.json", NOW, outlook=False)
    between = json.dumps(cold | {"started_at": f"2026-{AT:02d}-15T09:00:00Z"}).encode()
    return cold["unit"], upload_and_date(storage, between, "b.json", NOW).id


def changes(storage: Storage, unit: str) -> dict[str, float]:
    """Difference of every zero in that session from the one before, in standard uncertainties."""
    with storage.database.reading() as store:
        found = known_of(store, unit)
    zeros = ((key.sensor, t) for key, t in zip(found.keys, found.tracks, strict=True) if key.parameter == "bias")
    return {
        sensor: float(abs(t.change[AT, 0] - t.change[AT - 1, 0]) / np.hypot(t.sigma[AT, 0], t.sigma[AT - 1, 0]))
        for sensor, t in zeros
    }


def flagged(storage: Storage, unit: str) -> set[str]:
    """Sensors with an open flag for a change through time."""
    with storage.database.reading() as store:
        found = Flags(store).page(FlagQuery(unit, unresolved=True))
    return {flag.place for flag in found if flag.matter in (Matter.JUMP, Matter.DRIFT)}


def due(storage: Storage, unit: str) -> datetime:
    """Date of the next calibration."""
    with storage.database.reading() as store:
        found = outlook_of(store, unit, NOW).due
    assert found is not None
    return found


@one_engine
def test_settling_is_taken_off_before_dates_and_flags_are_made(storage: Storage) -> None:
    unit, id = measured(storage)
    assert sum(size > 6 for size in changes(storage, unit).values()) >= 3
    early = due(storage, unit)
    diagnose(storage, id, NOW)
    assert max(changes(storage, unit).values()) < 5
    assert flagged(storage, unit) == set()
    assert due(storage, unit) > early
