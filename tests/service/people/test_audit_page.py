"""The page of the audit trail."""

import httpx

from tests.databases import one_engine
from tests.service.made_sessions import session_bytes, session_id


@one_engine
def test_it_shows_who_did_what_and_checks_the_chain_when_asked(client: httpx.Client) -> None:
    client.post("/api/v1/sessions", content=session_bytes())
    plain, checked = client.get("/audit"), client.get("/audit?check=true")
    assert "upload" in plain.text
    assert "follow from one another" not in plain.text
    assert "follow from one another" in checked.text
    assert "diagnose" not in client.get("/audit", params={"subject": "nobody"}).text
    assert "upload" in client.get("/audit", params={"subject": session_id(session_bytes())}).text
