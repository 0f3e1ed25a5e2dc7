"""The pages of uploads: each is found again with what became of it."""

import re

import httpx
import pytest

from service.uploads.arrivals_pages import ArrivalsQuery, arrivals_query
from tests.service.made_sessions import session_bytes, session_id


def test_an_upload_is_found_again(client: httpx.Client) -> None:
    good = session_bytes()
    files = [("files", ("<b>good.json", good)), ("files", ("bad.json", b'{"format": "imu-session/1"}'))]
    client.post("/upload", files=files)
    page = client.get("/uploads").text
    assert f'<a href="/sessions/{session_id(good)}">&lt;b&gt;good.json</a>' in page
    refused = re.search(r'<a href="(/uploads/\d+)">bad.json</a>', page)
    assert refused is not None
    assert "nothing was stored" in page
    problems = client.get(refused.group(1)).text
    assert "Correct what is listed" in problems
    assert "<code>sensors</code>" in problems
    assert "good.json" not in client.get("/uploads?only=refused").text
    assert "bad.json" not in client.get("/uploads?q=good").text
    assert client.get("/uploads/999").status_code == 404


@pytest.mark.parametrize(
    ("after", "session", "refusal"),
    [("", None, None), ("r12", None, 12), ("5e55", "5e55", None), ("r", "r", None), ("r\u0661", "r\u0661", None)],
)
def test_a_page_goes_on_after_a_session_or_a_refusal(after: str, session: str | None, refusal: int | None) -> None:
    query = arrivals_query(ArrivalsQuery(after=after))
    assert (query.after_session, query.after_refusal) == (session, refusal)
