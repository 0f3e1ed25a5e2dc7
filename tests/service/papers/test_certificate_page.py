"""Names of papers on pages: customers, and a broken chain above the parameters."""

import httpx

from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.made_sessions import FAILED, session_id
from tests.service.papers.laboratory import CUSTOMER, STAND, state_all


def sent(client: httpx.Client, path: str, form: dict[str, str]) -> httpx.Response:
    """A form as this site's own page sends it."""
    origin = str(client.base_url).rstrip("/")
    return client.post(path, data=form, headers={"Origin": origin, "Sec-Fetch-Site": "same-origin"})


@one_engine
def test_a_form_of_another_site_changes_nothing(flagged: httpx.Client) -> None:
    foreign = {"Origin": "https://example.org", "Sec-Fetch-Site": "cross-site"}
    answer = flagged.post("/stands/ODG-1/certificates", data=STAND, headers=foreign)
    assert answer.status_code == 403
    assert "No certificate recorded" in flagged.get("/stands/ODG-1").text


def test_the_customer_is_named_on_the_unit_s_page(flagged: httpx.Client) -> None:
    assert "No customer entered" in flagged.get("/units/BA-017").text
    assert sent(flagged, "/units/BA-017/customer", CUSTOMER).status_code == 303
    page = flagged.get("/units/BA-017").text
    assert "<b>Aero Works Ltd</b>, 1 Hangar Road, Derby" in page
    assert "/api/v1/units/BA-017/label.pdf" in page


def test_a_broken_chain_stands_above_the_parameters(holding: Holding) -> None:
    client = holding(*FAILED, diagnosed=True)
    address = f"/sessions/{session_id(FAILED[-1])}"
    assert "Traceability is interrupted" not in client.get(address).text
    state_all(client, valid_until="2026-01-31")
    page = client.get(address).text
    assert 0 < page.index("Traceability is interrupted") < page.index("h-parameters")
