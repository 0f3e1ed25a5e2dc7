"""Certificates of several sessions, printed at once."""

import io

import httpx
import pytest
from pypdf import PdfReader, PdfWriter
from pypdf.annotations import Rectangle
from pypdf.generic import NameObject

from service.papers.desk import joined
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import session_bytes, session_id
from tests.service.papers.documents import pages_of

FIRST, SECOND = session_bytes(month=1), session_bytes(seed=2, unit="BA-018", month=2)
IDS = [session_id(SECOND), session_id(FIRST)]


def printed(client: httpx.Client, *ids: str) -> httpx.Response:
    """The answer for these sessions."""
    return client.get("/api/v1/certificates", params={"session": list(ids)})


@pytest.mark.slow
def test_the_pages_of_each_follow_in_the_order_asked_for(holding: Holding) -> None:
    client = holding(FIRST, SECOND)
    alone = [pages_of(client.get(f"/api/v1/sessions/{id}/certificate").content) for id in IDS]
    answer = printed(client, *IDS, IDS[0])
    assert answer.headers["content-type"] == "application/pdf"
    assert pages_of(answer.content) == alone[0] + alone[1]


def test_a_session_that_has_none_is_named_and_nothing_is_issued(holding: Holding) -> None:
    client = holding(FIRST)
    answer = printed(client, IDS[1], "nobody")
    assert (answer.status_code, [p["field"] for p in answer.json()["problems"]]) == (422, ["nobody"])
    assert client.get(f"/api/v1/sessions/{IDS[1]}/certificates").json()["certificates"] == []


def test_nothing_ticked_is_refused(holding: Holding) -> None:
    assert printed(holding(FIRST)).status_code == 422


def test_a_signature_of_one_file_is_not_carried_into_another() -> None:
    writer, file = PdfWriter(), io.BytesIO()
    page = writer.add_blank_page(100, 100)
    mark = writer.add_annotation(page, Rectangle(rect=(0, 0, 9, 9)))
    mark[NameObject("/Subtype")] = NameObject("/Widget")
    writer.write(file)
    assert "/Annots" in PdfReader(io.BytesIO(file.getvalue())).pages[0]
    together = PdfReader(io.BytesIO(joined([file.getvalue()])))
    assert not together.pages[0].get("/Annots")
