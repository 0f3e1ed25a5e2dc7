"""A unit measured just after switching on, with warm sessions behind it: settling is no drift of its sensors."""

import json
from datetime import UTC, datetime
from functools import cache

import numpy as np
import pytest

from service.flags.records import Matter
from service.flags.store import FlagQuery, Flags
from service.outlook.changes import known_of
from service.outlook.reading import outlook_of
from service.records.diagnose import diagnose
from service.storage import Storage
from service.uploads.receive import upload
from tests.blind.courses import BLOCKS, BOTH, COLD, Life, draw_life
from tests.databases import one_engine
from tests.service.dated import upload_and_date

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
EARLIER = 5


@cache
def life(kind: str) -> Life:
    return draw_life(BLOCKS[0], kind, 20.0, np.random.default_rng((62, 1)), earlier=EARLIER)


def measured(storage: Storage, kind: str) -> tuple[str, str]:
    """The unit, and the session just after switching on, not diagnosed yet."""
    *earlier, last = (json.dumps(session).encode() for session in life(kind).sessions)
    for content in earlier:
        upload(storage, content, "a.json", NOW, outlook=False)
    return life(kind).sessions[0]["unit"], upload_and_date(storage, last, "b.json", NOW).id


def changes(storage: Storage, unit: str) -> dict[str, float]:
    """By how many standard uncertainties every zero differs in the last session from the one before."""
    with storage.database.reading() as store:
        found = known_of(store, unit)
    zeros = ((key.sensor, t) for key, t in zip(found.keys, found.tracks, strict=True) if key.parameter == "bias")
    return {
        sensor: float(abs(t.change[-1, 0] - t.change[-2, 0]) / np.hypot(t.sigma[-1, 0], t.sigma[-2, 0]))
        for sensor, t in zeros
    }


def flagged(storage: Storage, unit: str) -> set[str]:
    """Sensors with an open flag for a change through time."""
    with storage.database.reading() as store:
        found = Flags(store).page(FlagQuery(unit, unresolved=True))
    return {flag.place for flag in found if flag.matter in (Matter.JUMP, Matter.DRIFT)}


@one_engine
@pytest.mark.parametrize("kind", [COLD, BOTH])
def test_settling_is_taken_off_before_dates_and_flags_are_made(storage: Storage, kind: str) -> None:
    unit, id = measured(storage, kind)
    assert sum(size > 6 for size in changes(storage, unit).values()) >= 3
    with storage.database.reading() as store:
        early = outlook_of(store, unit, NOW).due
    diagnose(storage, id, NOW)
    after = changes(storage, unit)
    own = set(life(kind).changed)
    assert {sensor for sensor, size in after.items() if size > 5} == own
    assert flagged(storage, unit) <= own
    with storage.database.reading() as store:
        due = outlook_of(store, unit, NOW).due
    assert own or (due is not None and (early is None or due >= early))
