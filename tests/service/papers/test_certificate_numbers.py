"""A certificate has a number of its own; one that states something else has another and names the one it replaces."""

from typing import Any
from xml.etree import ElementTree

import httpx
import pytest
from sqlalchemy import text
from sqlalchemy.exc import DatabaseError

from service.storage.engine import open_engine
from tests.conftest import Holding, SettingsHolding
from tests.service.diagnosed import ECCENTRIC, accepted, held
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.documents import text_of
from tests.service.papers.laboratory import CUSTOMER, named
from tests.service.papers.schema import DCC

ID = session_id(FAILED[-1])


def paper(client: httpx.Client, id: str = ID, **query: str) -> bytes:
    """The certificate."""
    answer = client.get(f"/api/v1/sessions/{id}/certificate", params=query)
    assert answer.status_code == 200, answer.text
    return answer.content


def issued(client: httpx.Client, id: str = ID) -> list[dict[str, Any]]:
    """All issues, the first one first."""
    found: list[dict[str, Any]] = client.get(f"/api/v1/sessions/{id}/certificates").json()["certificates"]
    return found


def test_the_same_again_has_the_same_number_and_the_same_bytes(flagged: httpx.Client) -> None:
    assert issued(flagged) == []
    assert paper(flagged, by="K. Ito") == paper(flagged, by="L. Berg")
    [issue] = issued(flagged)
    assert (issue["number"], issue["who"], issue["replaces"]) == (f"{ID}-0-1", "K. Ito", None)


def test_pdf_and_xml_share_the_number(flagged: httpx.Client) -> None:
    root = ElementTree.fromstring(paper(flagged, format="dcc"))
    assert root.findtext(f".//{DCC}uniqueIdentifier") == f"{ID}-0-1"
    assert f"No. {ID}-0-1" in text_of(paper(flagged))
    assert len(issued(flagged)) == 1


def test_a_later_session_changes_no_number(flagged: httpx.Client) -> None:
    paper(flagged)
    flagged.post("/api/v1/sessions", content=session_bytes(seed=3, month=6)).raise_for_status()
    paper(flagged)
    assert len(issued(flagged)) == 1


def test_what_is_computed_again_replaces_the_certificate_before(holding: Holding) -> None:
    client, id = held(holding, ECCENTRIC)
    paper(client, id)
    _, revision = accepted(client, id)
    after = text_of(paper(client, id))
    first, second = issued(client, id)
    assert second["number"] == f"{id}-{revision}-2"
    assert second["replaces"] == first["number"] == f"{id}-0-1"
    assert f"Replaces No. {id}-0-1" in after


def test_the_xml_names_what_it_replaces(flagged: httpx.Client) -> None:
    paper(flagged)
    flagged.put("/api/v1/units/BA-017/customer", json=CUSTOMER).raise_for_status()
    root = ElementTree.fromstring(paper(flagged, format="dcc"))
    assert root.findtext(f".//{DCC}replacedUniqueIdentifier") == f"{ID}-0-1"
    assert root.findtext(f".//{DCC}typeOfChange") == "substituted"


def test_another_laboratory_is_another_certificate(settings_holding: SettingsHolding) -> None:
    settings = settings_holding(*FAILED, diagnosed=True)
    for name in ("North", "South"):
        with named(settings, laboratory_name=name) as client:
            assert name in text_of(paper(client))
            numbers = [issue["number"] for issue in issued(client)]
    assert numbers == [f"{ID}-0-1", f"{ID}-0-2"]


def test_the_numbers_cannot_be_changed(settings_holding: SettingsHolding) -> None:
    settings = settings_holding(*FAILED, diagnosed=True)
    with named(settings) as client:
        paper(client)
    engine = open_engine(settings.database)
    for statement in ("UPDATE certificates SET number = 'x'", "DELETE FROM certificates"):
        with pytest.raises(DatabaseError, match="append-only"), engine.begin() as connection:
            connection.execute(text(statement))
    engine.dispose()


def test_an_unknown_session_has_none(client: httpx.Client) -> None:
    assert client.get("/api/v1/sessions/none/certificates").status_code == 404
