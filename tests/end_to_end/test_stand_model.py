"""An engineer's work: an eccentric head that several units show together is found and accepted for the stand, every
unit on it is computed again beside the requests, and the pages say what that changed.
"""

import json
import re
from collections.abc import Iterator
from typing import Any

import httpx
import numpy as np
import pytest

from service.app import create_app
from service.settings import Settings
from tests.blind.physics import measure
from tests.blind.world import Effect
from tests.blind.write import session_file
from tests.databases import one_engine
from tests.estimator.groups.cases import worlds
from tests.patience import until
from tests.serving import http_client

UNITS = ("BB-1", "BB-2")
SIZE = 2.5e-5
ECCENTRIC = [Effect("beta-eccentricity", (SIZE, -SIZE))]


def contents() -> Iterator[bytes]:
    """Sessions on one stand, of two units in turn, by a generator that knows nothing of the estimator."""
    for number, world in enumerate(worlds(8)):
        readings = measure(world, ECCENTRIC, np.random.default_rng(80 + number))[0]
        document = session_file(world, readings)
        yield json.dumps(document | {"unit": UNITS[number % 2], "unit_type": "BB"}).encode()


@pytest.fixture
def bench(settings: Settings) -> Iterator[httpx.Client]:
    """A service that works beside its requests, with the sessions of both units."""
    with http_client(create_app(settings.model_copy(update={"diagnosis_workers": 1}))) as client:
        for content in contents():
            client.post("/api/v1/sessions", content=content).raise_for_status()
        yield client


def words(client: httpx.Client, path: str) -> str:
    text = client.get(path, headers={"Accept": "text/html"}).raise_for_status().text
    return " ".join(re.sub(r"<[^>]+>", " ", text).split())


@one_engine
def test_found_accepted_computed_again_and_shown(bench: httpx.Client) -> None:
    stand = json.loads(next(contents()))["stand"]["id"]
    answer = f"/api/v1/stands/{stand}/diagnosis"

    def found() -> dict[str, Any] | None:
        told: dict[str, Any] = bench.get(answer).json()
        return told if told.get("sessions") == 8 else None

    (finding,) = until(found)["findings"]
    assert (finding["cause"], finding["level"]) == ("beta-eccentricity", "stand")
    until(lambda: "Seen with BB-1, BB-2." in bench.get("/api/v1/flags").text)
    made = bench.post(f"{answer}/accept", json={"cause": finding["cause"], "by": "K. Ito"}).raise_for_status().json()

    def done() -> list[dict[str, Any]] | None:
        each: list[dict[str, Any]] = bench.get(f"/api/v1/models/{made['id']}").json()["recomputations"]
        return each if all(one["state"] == "done" for one in each) else None

    assert [(one["unit"], one["outcome"]["recomputed"]) for one in until(done)] == [("BB-1", 4), ("BB-2", 4)]
    page = words(bench, f"/models/{made['id']}")
    assert "8 sessions of 2 of 2 units computed again" in page
    assert re.search(r"BB-1 4 of 4 [a-z ]+ of \S+ by .*?BB-2 4 of 4", page)
    assert f"revision {made['id']}" in words(bench, f"/stands/{stand}")
    assert {one["model_revision"] for one in corrections(bench)} == {made["id"]}


def corrections(client: httpx.Client) -> list[dict[str, Any]]:
    """Corrections for firmware, from every session as it stands."""
    sessions = client.get("/api/v1/sessions").json()["sessions"]
    return [client.get(f"/api/v1/sessions/{one['id']}/correction").json() for one in sessions]
