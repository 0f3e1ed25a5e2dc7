"""docs/how-to/add-a-page.md, followed: route, frozen context, template."""

import json

from tests.how_to.conftest import Served
from tests.service.made_sessions import session_bytes


def test_a_service_without_sessions_says_so(served: Served) -> None:
    assert "No session names a stand yet." in served.seating


def test_the_stand_of_a_session_stands_on_the_page(served: Served) -> None:
    document = json.loads(session_bytes(unit="ON-A-STAND"))
    document["stand"]["id"] = "SEAT-1"
    served.http.post("/api/v1/sessions", content=json.dumps(document)).raise_for_status()
    assert '<th scope="row">SEAT-1</th><td>1</td><td>' in served.http.get("/seating").text
