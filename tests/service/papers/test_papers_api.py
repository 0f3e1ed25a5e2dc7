"""Customers, certificates of stands, and what a session is called whose stand's certificate had expired."""

from typing import Any

import httpx
import pytest

from tests.conftest import SettingsHolding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.databases import one_engine
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.documents import pages_of, text_of
from tests.service.papers.laboratory import CUSTOMER, STAND, named, state_all

ID = session_id(FAILED[-1])
"""Measured on 1 February 2026."""


def session(client: httpx.Client, id: str = ID) -> dict[str, Any]:
    """The session as JSON."""
    found: dict[str, Any] = client.get(f"/api/v1/sessions/{id}").json()
    return found


def certificate(client: httpx.Client) -> bytes:
    """The certificate as PDF."""
    return client.get(f"/api/v1/sessions/{ID}/certificate").raise_for_status().content


@pytest.mark.parametrize(
    ("issued_on", "valid_until", "state"),
    [
        ("2025-01-01", "2026-01-31", "interrupted"),
        ("2025-01-01", "2026-02-01", "traceable"),
        ("2026-02-01", "2027-02-01", "traceable"),
        ("2026-02-02", "2027-02-01", "not-stated"),
    ],
)
@one_engine
def test_the_day_of_measurement_decides(flagged: httpx.Client, issued_on: str, valid_until: str, state: str) -> None:
    verdict = session(flagged)["verdict"]
    state_all(flagged, issued_on=issued_on, valid_until=valid_until)
    found = session(flagged)
    assert (found["traceability"]["state"], found["verdict"]) == (state, verdict)
    assert found["stand_certificate_expired"] == (state == "interrupted")


def test_an_expired_certificate_is_said_on_the_first_page(flagged: httpx.Client) -> None:
    state_all(flagged, valid_until="2026-01-31")
    first, *_ = pages_of(certificate(flagged))
    assert "Traceability is interrupted: certificate D-K-117 of stand ODG-1, issued by PTB" in first
    assert "had expired on 31 Jan 2026, before the day of measurement, 1 Feb 2026." in first
    assert "Traceable to the SI" not in first


def test_nothing_on_record_is_never_called_traceable(flagged: httpx.Client) -> None:
    assert session(flagged)["traceability"]["state"] == "not-stated"
    text = text_of(certificate(flagged))
    assert "Traceability is not stated: no certificate of stand ODG-1" in text
    assert "Traceable" not in text


def test_a_new_certificate_leaves_older_sessions_with_theirs(flagged: httpx.Client) -> None:
    state_all(flagged, valid_until="2026-01-31")
    state_all(flagged, number="D-K-118", issued_on="2026-02-10", valid_until="2028-01-01")
    assert session(flagged)["traceability"]["certificate"]["number"] == "D-K-117"
    kept = flagged.get("/api/v1/stands/ODG-1/certificates").json()["certificates"]
    assert [one["number"] for one in kept] == ["D-K-117", "D-K-118"]


def test_a_number_recorded_again_is_put_right(flagged: httpx.Client) -> None:
    state_all(flagged, valid_until="2026-01-31")
    state_all(flagged)
    assert session(flagged)["traceability"]["state"] == "traceable"
    assert len(flagged.get("/api/v1/stands/ODG-1/certificates").json()["certificates"]) == 1


def test_dates_in_the_wrong_order_are_refused(flagged: httpx.Client) -> None:
    answer = flagged.put("/api/v1/stands/ODG-1/certificate", json=STAND | {"valid_until": "2020-01-01"})
    assert (answer.status_code, answer.json()["problems"][0]["field"]) == (422, "valid_until")


def test_an_unknown_stand_is_not_found(flagged: httpx.Client) -> None:
    assert flagged.put("/api/v1/stands/none/certificate", json=STAND).status_code == 404


def test_the_customer_is_kept_and_printed(flagged: httpx.Client) -> None:
    assert flagged.get("/api/v1/units/BA-017/customer").json() == {"name": "", "address": ""}
    flagged.put("/api/v1/units/BA-017/customer", json=CUSTOMER).raise_for_status()
    kept = flagged.get("/api/v1/units/BA-017/customer").json()
    assert kept == {"name": CUSTOMER["name"], "address": CUSTOMER["address"]}
    assert "Customer Aero Works Ltd, 1 Hangar Road, Derby" in text_of(certificate(flagged))
    assert flagged.put("/api/v1/units/none/customer", json=CUSTOMER).status_code == 404


def test_names_that_nobody_set_make_a_draft(settings_holding: SettingsHolding) -> None:
    with named(settings_holding(*FAILED), laboratory_address="") as client:
        text = text_of(certificate(client))
    assert "Laboratory Inertial Laboratory North, not stated, DE" in text
    assert "Draft, not an accredited certificate: address of the laboratory, name of the customer" in text


@one_engine
def test_a_session_without_a_day_is_a_draft(settings_holding: SettingsHolding) -> None:
    undated = session_bytes(started_at=None)
    with named(settings_holding(undated)) as client:
        state_all(client)
        text = text_of(client.get(f"/api/v1/sessions/{session_id(undated)}/certificate").raise_for_status().content)
    assert "Draft, not an accredited certificate: day of measurement not stated." in text
    assert "Measured day not stated" in text
