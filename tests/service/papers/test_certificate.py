"""The certificate of a session, as it comes over HTTP."""

import hashlib
from datetime import UTC, datetime
from typing import Any

import httpx
import pytest

from estimator.health.rule import RULE
from service.sessions.words.conditions import condition_of
from service.storage import Storage
from service.uploads.receive import upload
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import ECCENTRIC, accepted, diagnosis_of, held
from tests.service.made_sessions import FAILED, session_bytes, session_id
from tests.service.papers.documents import pages_of, text_of
from tests.service.recordings import recording_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def sent(client: httpx.Client, content: bytes) -> dict[str, Any]:
    """The receipt of an upload."""
    answer = client.post("/api/v1/sessions", content=content)
    assert answer.status_code == 201, answer.text
    receipt: dict[str, Any] = answer.json()
    return receipt


def certificate(client: httpx.Client, id: str) -> bytes:
    """The certificate as PDF."""
    answer = client.get(f"/api/v1/sessions/{id}/certificate")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/pdf"), answer.text
    return answer.content


ID = session_id(FAILED[-1])


def test_it_states_input_verdict_rule_and_model(flagged: httpx.Client) -> None:
    text = text_of(certificate(flagged, ID))
    digest = hashlib.sha256(FAILED[-1]).hexdigest()
    for stated in (
        "Unfit",
        digest,
        RULE,
        "baseline (0)",
        "imu-health 0.",
        "BA-017",
        "K. Ito",
        "ODG-1",
    ):
        assert stated in text


def test_it_states_every_decision(flagged: httpx.Client) -> None:
    text = text_of(certificate(flagged, ID))
    decisions = flagged.get(f"/api/v1/sessions/{ID}").json()["decisions"]
    assert len(decisions) == 24
    states = [condition_of(d["verdict"]).word for d in decisions]
    # The decision rule explains each state once.
    assert all(text.count(f"% {state}") == states.count(state) for state in set(states))
    [a3] = [d for d in decisions if (d["sensor"], d["parameter"]) == ("A3", "bias")]
    assert f"+{a3['deviation'] / 9.80665e-6:.1f}" in text


def test_pages_are_numbered_and_name_the_unit(flagged: httpx.Client) -> None:
    pages = pages_of(certificate(flagged, ID))
    assert len(pages) > 1
    for number, text in enumerate(pages, 1):
        assert f"Page {number} of {len(pages)}" in text
        assert f"No. {ID}-0-1" in text
        assert "SIMULATED" not in text


def test_the_same_record_gives_the_same_bytes_whatever_comes_later(flagged: httpx.Client) -> None:
    before = certificate(flagged, ID)
    sent(flagged, session_bytes(seed=3, month=6, a3_moved=400.0))
    assert certificate(flagged, ID) == before


def test_the_reference_says_that_it_is_one(client: httpx.Client) -> None:
    text = text_of(certificate(client, sent(client, session_bytes())["id"]))
    assert "Reference set" in text
    assert "it is the reference of later sessions" in text


def test_named_causes_stand_with_their_amplitude(holding: Holding) -> None:
    client, id = held(holding, ECCENTRIC)
    [finding] = diagnosis_of(client, id)["findings"]
    text = text_of(certificate(client, id))
    assert finding["sentence"] in text
    assert f"{finding['strength']:.1f} standard errors" in text
    assert "Amplitude (± U, k = 2): " in text


def test_an_accepted_cause_is_named_as_the_model(holding: Holding) -> None:
    client, id = held(holding, ECCENTRIC)
    finding, revision = accepted(client, id)
    model = f"revision {revision}: baseline with {finding['cause'].replace('-', ' ')}"
    assert model in text_of(certificate(client, id))


def test_simulated_units_are_marked_on_every_page(storage: Storage, client: httpx.Client) -> None:
    id = upload(storage, session_bytes(origin="simulated"), "a.json", NOW).id
    pages = pages_of(certificate(client, id))
    assert len(pages) > 1
    assert all("SIMULATED" in page and "No. specimen-" in page for page in pages)
    assert "Specimen, not a certificate" in pages[0]


@pytest.mark.parametrize(
    ("name", "printed"),
    [
        ('#panic("no") $x^2$ ]*_`@<a>//', '#panic("no") $x^2$ ]*_`@<a>//'),
        ("\\u{41}\\ #sys.inputs", "\\u{41}\\ #sys.inputs"),
        ("Иванова Ё. 王芳", "Иванова Ё. ‹U+738B›‹U+82B3›"),
        ("right\u202eleft", "right‹U+202E›left"),
    ],
)
def test_no_text_is_taken_for_markup(client: httpx.Client, name: str, printed: str) -> None:
    receipt = sent(client, session_bytes(operator=name, notes=name))
    assert text_of(certificate(client, receipt["id"])).count(printed) == 2


def test_long_names_break(client: httpx.Client) -> None:
    receipt = sent(client, session_bytes(operator="W" * 190, unit="N" * 150, notes="notes " * 300))
    pages = pages_of(certificate(client, receipt["id"]))
    assert "W" * 190 in pages[0].replace("\u200b", "").replace(" ", "")


def test_as_found_and_as_left_stand_beside_each_other(client: httpx.Client) -> None:
    sent(client, session_bytes(seed=1))
    found = sent(client, session_bytes(seed=2, month=5, a3_moved=200.0, stage="as-found"))
    repair = {"kind": "adjustment", "at": "2026-05-20T12:00:00Z"}
    client.post("/api/v1/units/BA-017/services", json=repair).raise_for_status()
    left = sent(client, session_bytes(seed=3, month=6, stage="as-left"))
    before, after = (text_of(certificate(client, receipt["id"])) for receipt in (found, left))
    assert ("Unfit as found" in before, "As found and as left" in before) == (True, False)
    assert f"As found: session {found['id'][:12]} of 1 May 2026" in after
    assert "last service: adjustment, 20 May 2026" in after
    row = after[after.index("A3 bias") :][:60]
    assert row.index("Unfit") < row.index("Fit")


def test_a_recording_in_service_is_no_calibration(client: httpx.Client) -> None:
    sent(client, session_bytes())
    text = text_of(certificate(client, sent(client, recording_bytes())["id"]))
    assert ("Check in service" in text, "Calibration certificate" in text) == (True, False)
    assert "parity/2" in text


def test_an_unknown_session_is_not_found(client: httpx.Client) -> None:
    assert client.get("/api/v1/sessions/none/certificate").status_code == 404
