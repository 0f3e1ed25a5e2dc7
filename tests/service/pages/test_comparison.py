"""Two sessions of a unit beside each other."""

import json
import re

import httpx
import numpy as np
import pytest

from estimator.results import Calibration
from service.pages.session.comparison import compare, in_common
from service.records.changes import record_service
from service.sessions.store import Sessions
from service.storage import Storage
from service.units.records import NewService, Service
from service.uploads.receive import upload
from tests.builders import accelerometer_block, true_sensors
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_records import NOW
from tests.service.made_sessions import FAILED, MICRO_G, session_bytes, session_id
from tests.service.pages.records import NOON, session_report

FIRST, SECOND = (session_id(content) for content in FAILED)


def test_the_parameter_that_moved_is_out_of_tolerance(flagged: httpx.Client) -> None:
    page = flagged.get("/compare", params={"a": SECOND, "b": FIRST}).text
    row = re.search(r"A3 bias</th>(.*?)</tr>", page, re.DOTALL)
    assert row is not None
    assert "Unfit: " in row.group(1)
    assert "±50\u202fµg" in row.group(1)
    assert "1 Jan 2026</time> to" in page


def test_the_change_is_the_difference_and_less_uncertain_on_one_stand(storage: Storage) -> None:
    for content in FAILED:
        upload(storage, content, "a.json", NOW)
    with storage.database.reading() as store:
        found = compare(store, FIRST, SECOND, 2.0)
    decisions = {(d.sensor, d.parameter): d for d in found.judged.decisions}
    a3 = decisions["A3", "bias"]
    difference = (found.after.sensor("A3").bias.value or 0) - (found.before.sensor("A3").bias.value or 0)
    assert a3.deviation == pytest.approx(difference)
    assert abs(difference - 90 * MICRO_G) < 4 * (a3.uncertainty or 0)
    parts = [c.sensor("A3").bias.repeatability or 0 for c in (found.before, found.after)]
    assert found.on_one_stand["A3", "bias"] == pytest.approx(np.hypot(parts[0], parts[1]))
    scale = [c.sensor("A3").scale.repeatability or 0 for c in (found.before, found.after)]
    assert found.on_one_stand["A3", "scale"] == pytest.approx(
        np.hypot(scale[0], scale[1]) / (found.before.sensor("A3").scale.value or 0)
    )
    assert all(own <= (decisions[key].uncertainty or 0) * (1 + 1e-9) for key, own in found.on_one_stand.items())


@pytest.mark.parametrize(("at", "between"), [(0, 0), (1, 1)], ids=["at the first session", "at the second"])
def test_a_service_lies_between_the_sessions_until_the_second_begins(storage: Storage, at: int, between: int) -> None:
    for content in FAILED:
        upload(storage, content, "a.json", NOW)
    with storage.database.reading() as store:
        begins = Sessions(store).get((FIRST, SECOND)[at]).started_at
    record_service(storage, "BA-017", NewService("repair", begins), NOW)
    with storage.database.reading() as store:
        assert len(compare(store, FIRST, SECOND, 2.0).services) == between


def diagonal_session(seed: int) -> bytes:
    """A session whose A2 points along (1, 1, 1)/√3, where the tangents of nearly equal axes may lie far apart."""
    document = accelerometer_block(8, seed=seed, sensors=true_sensors(8), positions=24)
    return json.dumps(document | {"started_at": f"2026-0{seed}-01T09:00:00Z"}).encode()


def simulated_axes(found: Calibration, rng: np.random.Generator) -> np.ndarray:
    """(n, 3) draws of A2's axis by the session's own covariance."""
    a2, first = found.sensor("A2"), found.names.index("A2.axis_1")
    own = found.repeatability[first : first + 2, first : first + 2]
    turns = rng.multivariate_normal(np.zeros(2), own, 40_000, method="cholesky")
    return np.asarray(a2.axis + turns @ a2.axis_tangents.T)


def test_covariances_of_two_axes_are_added_in_one_frame(storage: Storage) -> None:
    ids = [upload(storage, diagonal_session(seed), "a.json", NOW).id for seed in (1, 3)]
    with storage.database.reading() as store:
        found = compare(store, ids[0], ids[1], 2.0)
    frames = [c.sensor("A2").axis_tangents for c in (found.before, found.after)]
    assert np.abs(frames[0] - frames[1]).max() > 0.5
    rng = np.random.default_rng(7)
    change = simulated_axes(found.after, rng) - simulated_axes(found.before, rng)
    assert found.on_one_stand["A2", "axis"] == pytest.approx(
        np.sqrt(np.linalg.eigvalsh(np.cov(change.T))[-1]), rel=0.02
    )


def test_sessions_on_two_stands_have_no_stand_in_common() -> None:
    first = session_report().session
    second = session_report(stand="ODG-2").session
    assert "ODG-1 and ODG-2" in in_common(first, second, ())[0]
    assert "its constant errors cancel" in in_common(first, first, ())[0]
    assert "Not both were measured on a stand" in in_common(first, session_report(stand=None).session, ())[0]
    said = in_common(first, session_report(revision=3).session, (Service(1, "BA-017", NOON, "repair", ""),))
    assert ["serviced between them (1 Mar 2026)" in " ".join(said), "revisions 0 and 3" in " ".join(said)] == [
        True,
        True,
    ]


@pytest.mark.parametrize(("a", "b", "status"), [(FIRST, FIRST, 409), (FIRST, "none", 404)])
def test_what_cannot_be_compared_is_refused(flagged: httpx.Client, a: str, b: str, status: int) -> None:
    assert flagged.get("/compare", params={"a": a, "b": b}).status_code == status


def test_sessions_of_two_units_are_not_compared(holding: Holding) -> None:
    other = session_bytes(unit="BA-018")
    client = holding(FAILED[0], other)
    answer = client.get("/compare", params={"a": FIRST, "b": session_id(other)})
    assert (answer.status_code, "BA-018" in answer.text) == (409, True)


def test_a_unit_s_page_leads_to_a_comparison(flagged: httpx.Client) -> None:
    page = flagged.get("/units/BA-017").text
    assert 'action="/compare"' in page
    assert page.count(f'<option value="{FIRST}"') == 2
