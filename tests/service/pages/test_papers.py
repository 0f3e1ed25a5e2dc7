"""The pages of what papers name: certificates of stands, customers, and a broken chain above the parameters."""

from datetime import date

import httpx
import pytest

from service.pages.stand_certificates import stand_certificates_page
from service.records.paper import StandCertificate
from tests.conftest import Holding
from tests.databases import one_engine
from tests.service.reports.laboratory import CUSTOMER, STAND, state_all
from tests.service.sessions import FAILED, session_id

CERTIFICATE = StandCertificate("ODG-1", "D-K-117", "PTB", date(2025, 12, 10), date(2026, 12, 10))


def sent(client: httpx.Client, path: str, form: dict[str, str]) -> httpx.Response:
    """A form as this site's own page sends it."""
    origin = str(client.base_url).rstrip("/")
    return client.post(path, data=form, headers={"Origin": origin, "Sec-Fetch-Site": "same-origin"})


def test_a_stand_s_certificate_is_recorded_by_its_form(flagged: httpx.Client) -> None:
    assert "No certificate on record" in flagged.get("/stand-certificates").text
    answer = sent(flagged, "/stand-certificates", STAND | {"stand": "ODG-1"})
    assert (answer.status_code, answer.headers["location"]) == (303, "/stand-certificates")
    page = flagged.get("/stand-certificates").text
    assert "D-K-117" in page
    assert "10 Dec 2026" in page


@one_engine
def test_a_form_of_another_site_changes_nothing(flagged: httpx.Client) -> None:
    foreign = {"Origin": "https://example.org", "Sec-Fetch-Site": "cross-site"}
    answer = flagged.post("/stand-certificates", data=STAND | {"stand": "ODG-1"}, headers=foreign)
    assert answer.status_code == 403
    assert "No certificate on record" in flagged.get("/stand-certificates").text


@pytest.mark.parametrize(
    ("today", "tone"),
    [(date(2025, 12, 9), "undecidable"), (date(2026, 12, 10), "pass"), (date(2026, 12, 11), "fail")],
)
def test_a_stand_has_the_tone_of_today(today: date, tone: str) -> None:
    [card] = stand_certificates_page({"ODG-1": (CERTIFICATE,)}, today).cards
    assert card.tone == tone


def test_the_customer_is_named_on_the_unit_s_page(flagged: httpx.Client) -> None:
    assert "a customer who is not stated" in flagged.get("/units/BA-017").text
    assert sent(flagged, "/units/BA-017/customer", CUSTOMER).status_code == 303
    page = flagged.get("/units/BA-017").text
    assert "<b>Aero Works Ltd</b>, 1 Hangar Road, Derby" in page
    assert "/api/v1/units/BA-017/label.pdf" in page


def test_a_broken_chain_stands_above_the_parameters(holding: Holding) -> None:
    client = holding(*FAILED)
    address = f"/sessions/{session_id(FAILED[-1])}"
    assert "Traceability is interrupted" not in client.get(address).text
    state_all(client, valid_until="2026-01-31")
    page = client.get(address).text
    assert 0 < page.index("Traceability is interrupted") < page.index("h-parameters")
