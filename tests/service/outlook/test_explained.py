"""An effect that a diagnosis attributes to the stand is no change of a sensor: neither flags nor dates count it."""

import json
from datetime import UTC, datetime
from functools import cache

import numpy as np
import pytest

from estimator.diagnosis import Finding
from estimator.diagnosis.results import Rival
from estimator.reading import read_session
from estimator.writing import session_document
from service.demo.blocks import DemoEffect, with_effect
from service.flags.records import Matter
from service.flags.store import FlagQuery, Flags
from service.outlook.changes import known_of
from service.outlook.explained import _probability
from service.outlook.reading import outlook_of
from service.outlook.records import UnitOutlook
from service.records.diagnose import diagnose
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import one_engine
from tests.service.dated import upload_and_date
from tests.service.made_sessions import MICRO_G, session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNIT = "BA-017"
SOUND, OFF, AFTER = (1, 3, 4, 5, 7, 8), 9, 10
"""Months of sessions before, while and after the head's scale was off centre."""
OFF_CENTRE = DemoEffect("beta-eccentricity", (80e-6, -40e-6))
SPOILT, SPARED = ("A2", "bias"), ("A1", "bias")
"""The parameter that it moves most, by half a tolerance, and one that it does not move."""


@cache
def eccentric(a3_moved: float) -> bytes:
    """The session on the stand with its head's scale off centre."""
    session = read_session(session_bytes(seed=OFF, month=OFF, a3_moved=a3_moved))
    document = session_document(with_effect(session, OFF_CENTRE))
    return json.dumps(document | {"started_at": f"2026-{OFF:02}-01T09:00:00Z"}).encode()


def measure(storage: Storage, a3_moved: float = 0.0) -> str:
    """The sessions up to the one on the stand at fault, whose identifier is returned; A3 jumps when it does."""
    for month in SOUND:
        upload(storage, session_bytes(seed=month, month=month), "a.json", NOW, outlook=False)
    return upload_and_date(storage, eccentric(a3_moved), "b.json", NOW).id


def outlook(storage: Storage) -> UnitOutlook:
    with storage.database.reading() as store:
        return outlook_of(store, UNIT, NOW)


def at_fault(storage: Storage, place: tuple[str, str]) -> tuple[float, float, float]:
    """The change of a parameter in the session on the stand at fault, its uncertainty, and that of a sound session on
    the same positions; in tolerances."""
    with storage.database.reading() as store:
        found = known_of(store, UNIT)
    track = next(t for key, t in zip(found.keys, found.tracks, strict=True) if (key.sensor, key.parameter) == place)
    numbers = np.array([track.change[-1, 0], track.sigma[-1, 0], track.sigma[-2, 0]]) / track.tolerance
    change, sigma, usual = numbers.tolist()
    return change, sigma, usual


def flagged(storage: Storage) -> dict[str, str]:
    """Sensors with an open flag for a change through time, and what it says."""
    with storage.database.reading() as store:
        found = Flags(store).page(FlagQuery(UNIT, unresolved=True))
    return {flag.place: flag.summary for flag in found if flag.matter in (Matter.JUMP, Matter.DRIFT)}


@one_engine
def test_what_the_stand_did_is_taken_off_and_what_is_left_is_as_uncertain_as_that(storage: Storage) -> None:
    id = measure(storage)
    change, *_ = at_fault(storage, SPOILT)
    assert abs(change) > 0.4
    early = outlook(storage).due
    diagnose(storage, id, NOW)
    change, sigma, usual = at_fault(storage, SPOILT)
    assert abs(change) < 3 * sigma < 0.3
    assert sigma > usual, "the fault's own uncertainty is added"
    _, sigma, usual = at_fault(storage, SPARED)
    assert sigma < 1.05 * usual
    assert early is not None
    assert outlook(storage).due == datetime(2027, 9, 1, 9, tzinfo=UTC) > early
    assert flagged(storage) == {}


@pytest.mark.slow
@one_engine
def test_a_sensor_that_jumps_while_the_stand_is_at_fault_is_flagged_with_its_own_jump(storage: Storage) -> None:
    diagnose(storage, measure(storage, a3_moved=40.0), NOW)
    after = session_bytes(seed=AFTER, month=AFTER, a3_moved=40.0)
    upload_and_date(storage, after, "c.json", NOW)
    assert list(flagged(storage)) == ["A3"]
    (change,) = next(t for t in outlook(storage).trends if (t.sensor, t.parameter) == ("A3", "bias")).changes
    assert (change.kind, change.after.month, change.before.month) == ("jump", SOUND[-1], OFF)
    assert change.size == pytest.approx(40 * MICRO_G, abs=3 * change.sigma)
    assert all(t.sensor == "A3" for t in outlook(storage).trends if t.changes)


@pytest.mark.parametrize(("share", "probability"), [(0.02, 0.98), (None, 0.5)])
def test_a_cause_beside_an_unknown_one_is_as_likely_as_its_ranking_says_or_else_as_the_other(
    share: float | None, probability: float
) -> None:
    ranking = [Rival("remount-rotation", (), 1 - (share or 0.0), 9.0)]
    ranking += [] if share is None else [Rival("unexplained", (), share, 0.0)]
    finding = Finding("remount-rotation", "", "", (), 0.0, 9.0, alternatives=("unexplained",), ranking=tuple(ranking))
    assert _probability(finding) == pytest.approx(probability)
