"""Two sessions of a unit beside each other."""

import re

import httpx
import numpy as np
import pytest

from service.flows.receive import upload
from service.records.event import Service
from service.storage import Storage
from service.views.comparison import compare
from service.words.comparison import in_common
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.pages.records import NOON, session_report
from tests.service.records import NOW
from tests.service.sessions import FAILED, MICRO_G, session_bytes, session_id

FIRST, SECOND = (session_id(content) for content in FAILED)


def test_the_parameter_that_moved_is_out_of_tolerance(flagged: httpx.Client) -> None:
    page = flagged.get("/compare", params={"a": SECOND, "b": FIRST}).text
    row = re.search(r"A3 bias</th>(.*?)</tr>", page, re.DOTALL)
    assert row is not None
    assert "fail: " in row.group(1)
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
    assert found.own["A3", "bias"] == pytest.approx(np.hypot(*parts))
    assert all(own <= (decisions[key].uncertainty or 0) * (1 + 1e-9) for key, own in found.own.items())


def test_sessions_on_two_stands_have_no_stand_in_common() -> None:
    first = session_report().session
    second = session_report(stand="ODG-2").session
    assert "ODG-1 and ODG-2" in in_common(first, second, ())[0]
    assert "its constant errors act on both alike" in in_common(first, first, ())[0]
    assert "not both measured on a stand" in in_common(first, session_report(stand=None).session, ())[0]
    said = in_common(first, session_report(revision=3).session, (Service(1, "BA-017", NOON, "repair", ""),))
    assert ["serviced (1 Mar 2026)" in " ".join(said), "revisions 0 and 3" in " ".join(said)] == [True, True]


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
