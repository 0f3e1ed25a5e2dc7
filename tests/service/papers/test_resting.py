"""A stand that was found bad: every certificate that rests on it."""

import httpx

from tests.builders import accelerometer_block
from tests.service.made_sessions import session_bytes

SECOND = accelerometer_block()["stand"] | {"id": "ODG-2"}
FIRST, ELSEWHERE, OTHER = (
    session_bytes(month=1),
    session_bytes(seed=2, month=2, stand=SECOND),
    session_bytes(seed=3, month=2, unit="BA-018", stand=SECOND),
)


def resting(client: httpx.Client, stand: str, **days: str) -> list[tuple[str, bool]]:
    answer = client.get(f"/api/v1/stands/{stand}/resting-certificates", params=days)
    answer.raise_for_status()
    return [(one["session"], one["is_measured_there"]) for one in answer.json()["certificates"]]


def test_certificates_of_sessions_on_it_and_of_those_judged_against_them(client: httpx.Client) -> None:
    ids = [client.post("/api/v1/sessions", content=content).json()["id"] for content in (FIRST, ELSEWHERE, OTHER)]
    assert resting(client, "ODG-1") == []
    for id in ids:
        client.get(f"/api/v1/sessions/{id}/certificate?format=dcc").raise_for_status()
    assert resting(client, "ODG-1") == [(ids[0], True), (ids[1], False)]
    assert resting(client, "ODG-2") == [(ids[1], True), (ids[2], True)]
    assert resting(client, "ODG-1", since="2026-01-02") == []
    assert resting(client, "ODG-1", until="2026-01-01") == [(ids[0], True), (ids[1], False)]
    assert client.get("/api/v1/stands/none/resting-certificates").status_code == 404
    lines = client.get("/api/v1/stands/ODG-1/resting-certificates?format=csv").text.splitlines()
    assert lines[0] == "number,unit,session,started_at,issued_at,is_measured_there"
    assert [line.split(",")[2:6:3] for line in lines[1:]] == [[ids[0], "true"], [ids[1], "false"]]
    page = client.get("/stands/ODG-1", headers={"Accept": "text/html"}).text
    assert 'action="/api/v1/stands/ODG-1/resting-certificates"' in page
