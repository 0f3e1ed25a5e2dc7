"""Every item that ISO/IEC 17025:2017 wants on a certificate stands where the documentation says it does."""

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import SettingsHolding
from tests.databases import one_engine
from tests.service.made_sessions import session_bytes, session_id
from tests.service.papers.documents import text_of
from tests.service.papers.laboratory import named, state_all

PAGE = Path(__file__).parents[3] / "docs" / "reports.md"
ROW = re.compile(r"^\| (7\.8\.[\d.]+ ?\w?) \| .*? \| `(.+)` \|$", re.MULTILINE)
CLAUSES = ROW.findall(PAGE.read_text("utf-8"))
WANTED = [f"7.8.2.1 {item}" for item in "abcdefghijklmnop"] + [f"7.8.4.1 {item}" for item in "abcdef"]
FOUND = session_bytes(seed=2, month=5, a3_moved=90.0, stage="as-found")
LEFT = session_bytes(seed=3, month=6, stage="as-left")
LATER = session_bytes(seed=4, month=7)


@pytest.fixture
def text(settings_holding: SettingsHolding) -> Iterator[str]:
    """The certificates of a unit as left, in its second issue, and of its next session; all that can be is stated."""
    with named(settings_holding(session_bytes(), FOUND)) as client:
        repair = {"kind": "adjustment", "at": "2026-05-20T12:00:00Z", "by": "K. Ito"}
        client.post("/api/v1/units/BA-017/services", json=repair).raise_for_status()
        client.post("/api/v1/sessions", content=LEFT).raise_for_status()
        left, later = (f"/api/v1/sessions/{session_id(content)}/certificate" for content in (LEFT, LATER))
        client.get(left).raise_for_status()
        state_all(client)
        client.post("/api/v1/sessions", content=LATER).raise_for_status()
        papers = (client.get(address).raise_for_status().content for address in (left, later))
        yield " ".join(text_of(paper) for paper in papers)


def test_no_clause_is_left_out() -> None:
    assert sorted(set(WANTED) - {clause for clause, _ in CLAUSES}) == []


@one_engine
def test_every_clause_is_on_the_paper_and_one_that_states_all_is_no_draft(text: str) -> None:
    assert [(clause, words) for clause, words in CLAUSES if words not in text] == []
    assert ("Draft" in text, "interrupted" in text) == (False, False)
