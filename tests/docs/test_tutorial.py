"""The tutorial: its table is the one that its pictures show, and its diagnosis is the one that it tells."""

import json
from pathlib import Path

import fastexcel
import httpx
import pytest

from tests.docs import bench
from tests.service import tables

DOCS = Path(__file__).parents[2] / "docs"
TABLE = DOCS / "examples" / "bench.xlsx"
TEXT = (DOCS / "tutorial.md").read_text("utf-8")


def test_the_table_is_what_the_bench_wrote() -> None:
    stored = fastexcel.read_excel(TABLE.read_bytes()).load_sheet(0).to_polars()
    assert [tuple(stored.columns), *stored.rows()] == [tuple(row) for row in bench.rows()]


@pytest.mark.parametrize("databases", ["sqlite"], indirect=True)
def test_the_table_is_understood_and_diagnosed_as_the_tutorial_says(client: httpx.Client) -> None:
    sent = {"file": (TABLE.name, TABLE.read_bytes())}
    found = client.post("/api/v1/layouts/preview", files=sent).json()["mapping"]
    mapping = {**found, "session": tables.facts_of(bench.session()) | {"started_at": "2026-03-01T12:00:00Z"}}
    stored = client.post("/api/v1/sessions", files=sent, data={"mapping": json.dumps(mapping)})
    assert stored.status_code == 201, stored.text
    (finding,) = client.get(f"/api/v1/sessions/{stored.json()['id']}/diagnosis").json()["findings"]
    assert (finding["cause"], finding["sensors"]) == ("bias-ramp", ["A2"])
    assert "**The bias of A2 drifts steadily during the session.**" in TEXT


def test_the_tutorial_says_what_the_pages_are_told() -> None:
    told = {text for text in bench.FACTS.values() if text not in TEXT}
    assert told == set()
