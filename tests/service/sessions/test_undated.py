"""Session files that state no date: they have the moment at which they were received, everywhere."""

import json
import re
from collections.abc import Iterator, Sequence
from typing import Any

import httpx
import pytest

from estimator.moments import moment
from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.grouped import CUBIC, cubic_session

UNIT, CAUSE = "BA-017", "cubic-nonlinearity"
LARGE = 8 * CUBIC
"""Plain in two sessions."""
HTML = {"Accept": "text/html"}


def session(number: int, cubic: float, started_at: str | None) -> bytes:
    """One of several sessions of the unit, with the effect or without."""
    document = json.loads(cubic_session(number, cubic=cubic)) | {"started_at": started_at}
    return json.dumps(document).encode()


SOUND = tuple(session(n, 0.0, None) for n in range(2))
SINCE = tuple(session(n, LARGE, None) for n in range(2, 4))
DATED = tuple(session(n, 0.0, f"2023-0{n + 1}-01T01:30:00+03:00") for n in range(2))


def stored(client: httpx.Client) -> list[dict[str, Any]]:
    """The unit's sessions, oldest first."""
    found: list[dict[str, Any]] = client.get("/api/v1/sessions", params={"unit": UNIT}).json()["sessions"]
    return sorted(found, key=lambda one: str(one["started_at"]))


def everything_of(client: httpx.Client) -> Iterator[str]:
    """Addresses of all that is shown and printed of the unit."""
    yield from ("/", f"/units/{UNIT}", "/unit-types/three", "/stands/ODG-1", "/sessions")
    api = "/api/v1"
    yield from (f"{api}/units/{UNIT}", f"{api}/units/{UNIT}/diagnosis", f"{api}/unit-types/three/diagnosis")
    yield from (f"{api}/stands/ODG-1/diagnosis", f"{api}/units/{UNIT}/usable", f"{api}/units/{UNIT}/outlook")
    yield from (f"{api}/units/{UNIT}/label.pdf", f"{api}/feeds/due.ics", f"{api}/models")
    yield from (f"{api}/units/{UNIT}/history?format={form}" for form in ("json", "csv", "parquet"))
    yield from (f"{api}/fleet/report?format={form}" for form in ("json", "csv", "xlsx"))
    for id in [one["id"] for one in stored(client)][-1:]:
        own = f"{api}/sessions/{id}"
        yield from (f"/sessions/{id}", f"{own}/diagnosis", f"{own}/calibration", f"{own}/correction")
        yield from (f"{own}/certificate?format=pdf", f"{own}/certificate?format=dcc")
        yield f"/sessions/{id}/diagnosis"


def refused(client: httpx.Client) -> dict[str, int]:
    """Status of every address that does not answer 200."""
    found = {path: client.get(path, headers=HTML if "/api/" not in path else {}) for path in everything_of(client)}
    return {path: answer.status_code for path, answer in found.items() if answer.status_code != 200}


@one_engine
@pytest.mark.parametrize(
    "sound", [pytest.param(SOUND, id="undated", marks=pytest.mark.slow), pytest.param(DATED, id="mixed")]
)
def test_what_began_in_a_file_without_a_date_is_shown_and_accepted(holding: Holding, sound: Sequence[bytes]) -> None:
    client = holding(*sound, *SINCE)
    (finding,) = client.get(f"/api/v1/units/{UNIT}/diagnosis").raise_for_status().json()["findings"]
    moments = [one["started_at"] for one in stored(client)]
    assert (finding["cause"], finding["form"], finding["since"]) == (CAUSE, "since", moments[2])
    assert [moment(one["started_at"]) for one in finding["sessions"]] == [moment(at) for at in moments]
    assert client.get(f"/units/{UNIT}", headers=HTML).status_code == 200
    body = {"cause": CAUSE, "sensors": ["A2"], "by": "K. Ito", "note": ""}
    client.post(f"/api/v1/units/{UNIT}/diagnosis/accept", json=body).raise_for_status()
    later = client.post("/api/v1/sessions", content=session(4, LARGE, None))
    assert (later.status_code, stored(client)[-1]["revision"]) == (201, 1)
    assert refused(client) == {}
    page = client.get("/models/1", headers=HTML).text
    assert re.search(r"since \d+ \w{3} \d{4}", page)
