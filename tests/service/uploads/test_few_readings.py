"""Sessions with too few readings over HTTP: stored, shown, and honest about what they do not tell."""

import json
from typing import Any

import httpx

from tests.builders import arbitrary_orientations
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - the hook
from tests.service.made_sessions import session_id

SAID = "Too few positions for an uncertainty: add 5"
HTML = {"Accept": "text/html"}


def triad(count: int, *, seed: int = 3, month: int = 3) -> bytes:
    """A triad in so many orientations, nothing said of its noise."""
    document = arbitrary_orientations(3, orientations=count, se=None, seed=seed)
    return json.dumps(document | {"started_at": f"2026-{month:02d}-03T09:00:00Z"}).encode()


def session_of(client: httpx.Client, content: bytes) -> dict[str, Any]:
    """The stored session."""
    found: dict[str, Any] = client.get(f"/api/v1/sessions/{session_id(content)}").json()
    return found


def test_it_is_undecidable_and_says_how_many_positions_to_add(holding: Holding) -> None:
    found = session_of(holding(triad(9)), triad(9))
    assert found["verdict"] == "undecidable"
    assert found["reason"].startswith(SAID)
    assert found["is_reference"] is False


def test_its_values_are_kept_without_uncertainty(holding: Holding) -> None:
    kept = holding(triad(9)).get(f"/api/v1/sessions/{session_id(triad(9))}/calibration").json()
    bias = kept["sensors"][0]["bias"]
    assert bias["value"] is not None
    assert (bias["sigma"], bias["coverage_factor"], kept["fit"]["positions_to_add"]) == (None, None, 5)


def test_its_page_and_its_papers_say_so(holding: Holding) -> None:
    client, id = holding(triad(9)), session_id(triad(9))
    page = client.get(f"/sessions/{id}", headers=HTML)
    assert page.status_code == 200
    assert SAID in page.text
    for paper in ("certificate", "certificate?format=dcc", "diagnosis"):
        assert client.get(f"/api/v1/sessions/{id}/{paper}").status_code == 200
    correction = client.get(f"/api/v1/sessions/{id}/correction").json()
    assert correction["blocks"][0]["example"]["expanded_uncertainty"] == [None] * 3


def test_the_card_of_the_upload_says_so(client: httpx.Client) -> None:
    answer = client.post("/upload", files={"files": ("few.json", triad(9))}, headers=HTML)
    assert SAID in answer.text


def test_the_next_session_becomes_the_reference(holding: Holding) -> None:
    better = triad(20, seed=4, month=4)
    assert session_of(holding(triad(9), better), better)["is_reference"] is True


def test_beside_a_reference_it_is_undecidable_for_the_same_reason(holding: Holding) -> None:
    few = triad(9, seed=4, month=4)
    found = session_of(holding(triad(20), few), few)
    assert (found["verdict"], found["reason"][: len(SAID)]) == ("undecidable", SAID)


def test_few_degrees_of_freedom_are_stated_with_each_decision(holding: Holding) -> None:
    few = triad(14, seed=4, month=4)
    client = holding(triad(24), few)
    decided = [d for d in session_of(client, few)["decisions"] if d["expanded"] is not None]
    assert all(d["dof"] is not None and d["coverage_factor"] > 2.05 for d in decided)
    assert "by Student&#39;s t" in client.get(f"/sessions/{session_id(few)}", headers=HTML).text
