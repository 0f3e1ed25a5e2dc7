"""A verdict across more °C than a unit's sessions cover says so wherever it stands."""

import json
from datetime import UTC, datetime

import httpx
import pytest

from service.papers.verifying.records import Outcome, RawFile
from service.papers.verifying.verify import Beside, verify
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.made_sessions import MICRO_G, session_bytes, session_id
from tests.service.papers.documents import text_of
from tests.service.recordings import recording_document

SAYS = "it was measured at 35 °C, 11 °C above its reference and earlier sessions (20–24 °C)"
AGAIN = "measure again at about 20 °C, or calibrate over temperature"


def at(celsius: float, month: int, *, moved: float = 0.0) -> bytes:
    """A session at a temperature; A3's bias is moved by some µg."""
    document = json.loads(session_bytes(seed=month, month=month, a3_moved=moved, m=4))
    document["table"]["temperature_c"] = [celsius] * len(document["table"]["A1"])
    return json.dumps(document).encode()


SESSIONS = (at(20.0, 1), at(24.0, 2), at(35.0, 3, moved=90.0))
"""A reference, a sound session as seasons change, and a warm one of which A3 reads otherwise."""


def plain(text: str) -> str:
    """The text without spaces that do not break."""
    return text.replace("\u00a0", " ").replace("\u202f", " ")


def test_it_is_said_with_the_verdict_and_no_replacement_is_advised(holding: Holding) -> None:
    client = holding(*SESSIONS, diagnosed=True)
    _, sound, warm = (client.get(f"/api/v1/sessions/{session_id(s)}").json() for s in SESSIONS)
    assert (sound["verdict"], sound["reservations"]) == ("pass", [])
    assert warm["verdict"] == "fail"
    (found,) = [r for r in warm["reservations"] if r["kind"] == "temperature"]
    assert plain(found["text"]).startswith(SAYS)
    assert plain(found["advice"]) == AGAIN
    assert plain(client.get("/api/v1/units/BA-017/usable").json()["reservation"]).startswith(f"I{SAYS[1:]}")
    diagnosis = client.get(f"/api/v1/sessions/{warm['id']}/diagnosis").json()
    (drift,) = [f for f in diagnosis["findings"] if f["cause"] == "sensor-drift"]
    assert (drift["sensors"], drift["alternatives"]) == (["A3"], ["bias-temperature"])
    pages = [client.get(path).text for path in (f"/sessions/{warm['id']}", "/units/BA-017", "/flags")]
    assert SAYS in plain(pages[0])
    assert "replacement" not in "".join(pages)


PER_DEGREE = 6.0
"""µg by which the bias of A3 follows the room."""
LEARNED = tuple(at(t, month, moved=PER_DEGREE * (t - 20)) for month, t in enumerate((20, 34, 22, 12, 30, 16, 26), 1))
WARM, DRIFTED = at(33.0, 8, moved=PER_DEGREE * 13), at(33.0, 9, moved=PER_DEGREE * 13 + 150)


COVERED = {"lowest": 12.0, "highest": 34.0, "reference": 20.0}
"""Temperatures covered by the sessions that the law was learned from: those far from the reference failed before it was
known.
"""


def is_covered_everywhere(client: httpx.Client, id: str) -> bool:
    """Whether everything that shows the session states its temperatures."""
    unit, session = "/api/v1/units/BA-017", f"/api/v1/sessions/{id}"
    answers = (client.get(path).json() for path in (unit, session, f"{session}/correction"))
    pages = (client.get(path).text for path in ("/units/BA-017", f"/sessions/{id}"))
    papers = client.get(f"{session}/certificate?format=dcc").text, text_of(client.get(f"{session}/certificate").content)
    said = [answer["temperatures_covered"] == COVERED for answer in answers]
    said += ["<dt>Temperatures covered</dt><dd>12.0 to 34.0 °C</dd>" in plain(page) for page in pages]
    return all([*said, *("12.0 to 34.0 °C" in plain(paper) for paper in papers)])


def test_the_law_of_the_sessions_before_brings_a_session_to_its_reference(holding: Holding) -> None:
    """Sessions may come in any order; a change beside the law fails."""
    client = holding(WARM, *LEARNED[3:], DRIFTED, *LEARNED[:3])
    warm, drifted = (client.get(f"/api/v1/sessions/{session_id(s)}").json() for s in (WARM, DRIFTED))
    assert (warm["verdict"], drifted["verdict"]) == ("pass", "fail")
    assert "A3 bias: change of 8" in warm["reason"]
    assert " at 20 °C by the law of 7 sessions. " in plain(warm["reason"])
    taken = {(d["sensor"], d["parameter"]): d["temperature_correction"] for d in warm["decisions"]}
    own = taken["A3", "bias"]
    assert own["measured"] == pytest.approx(own["worth"] + own["corrected"])
    assert abs(own["measured"] - PER_DEGREE * 13 * MICRO_G) < 5 * MICRO_G
    assert abs(own["corrected"]) < own["expanded"] < 20 * MICRO_G
    assert (own["temperature"], own["reference_temperature"], own["sessions"]) == (33.0, 20.0, 7)
    assert [place for place, one in taken.items() if one is not None] == [("A3", "bias")]
    assert "Measured at 33 °C and judged at 20 °C, by the law of 7 sessions: A3 bias 80.0 µg → " in plain(
        client.get(f"/sessions/{warm['id']}").text
    )
    (law,) = client.get(f"/api/v1/sessions/{warm['id']}/correction").json()["temperature_laws"]
    assert (law["sensor"], law["parameter"], law["worth"]) == ("A3", "bias", own["worth"])
    certificate = client.get(f"/api/v1/sessions/{warm['id']}/certificate?format=dcc")
    assert "deviation at 33.0 °C, before the law of 7 sessions over temperature" in certificate.text
    again = verify(certificate.content, RawFile("warm.json", WARM), Beside(), datetime.now(UTC))
    assert again.outcome is Outcome.AGREES, again
    assert is_covered_everywhere(client, warm["id"])
    alone = client.get(f"/api/v1/sessions/{session_id(LEARNED[0])}").json()["temperatures_covered"]
    assert alone == {"lowest": 20.0, "highest": 20.0, "reference": 20.0}
    (moved,) = [d for d in drifted["decisions"] if d["verdict"] == "fail"]
    assert moved["deviation"] == pytest.approx(150 * MICRO_G, abs=20 * MICRO_G)


@pytest.mark.slow
def test_a_session_taken_back_is_no_longer_learned_from(holding: Holding) -> None:
    client = holding(*LEARNED, WARM)
    for gone in LEARNED[1:3]:
        why = {"by": "K. Ito", "why": "wrong unit"}
        client.post(f"/api/v1/sessions/{session_id(gone)}/withdraw", json=why).raise_for_status()
    warm = client.get(f"/api/v1/sessions/{session_id(WARM)}").json()
    assert warm["verdict"] == "fail"
    assert not any(d["temperature_correction"] for d in warm["decisions"])


def recorded(celsius: float, month: int) -> bytes:
    """A recording in service at a temperature."""
    document = recording_document(m=4) | {"started_at": f"2026-{month:02d}-01T09:00:00Z"}
    document["table"]["temperature_c"] = [celsius] * len(document["table"]["A1"])
    return json.dumps(document).encode()


def test_a_unit_that_is_used_elsewhere_says_so(holding: Holding) -> None:
    near, far = recorded(22.0, 5), recorded(-4.0, 6)
    client = holding(SESSIONS[0], near, far, diagnosed=True)
    at_home, away = (client.get(f"/api/v1/sessions/{session_id(s)}").json()["reservations"] for s in (near, far))
    assert at_home == []
    (found,) = away
    assert found["kind"] == "temperature"
    assert plain(found["text"]) == (
        "it was measured at −4 °C, 24 °C below its reference and earlier sessions (20 °C); "
        "temperature alone can cause or hide a change of unknown size"
    )
