"""Alignments, rate tables and recordings in service through the flows that were made for calibrations."""

import json
import re
from dataclasses import replace
from datetime import UTC, datetime

import pytest

from estimator.session import CALIBRATIONS, IN_SERVICE, PROGRAMMES
from service.flags.records import Matter
from service.flags.store import Flags
from service.judging.calibrate import rests_on_model
from service.models.records import ModelRevision, Scope
from service.models.store import Models
from service.records.diagnose import diagnose, task_of
from service.records.recalibrate import recalibrate
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Verdict
from service.sessions.records import DiagnosisState
from service.sessions.store import Sessions
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from tests.conftest import Holding
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.service.diagnosed import TEMPERATURE, drawn
from tests.service.made_sessions import session_bytes, session_id
from tests.service.recordings import recording_bytes
from tests.service.turntable import alignment_bytes, rate_table_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
CUBIC = ModelRevision(
    id=0, scope=Scope.UNIT, subject="BA-017", cause="cubic-nonlinearity", sensors=("A3",), session="", evidence=None,
    accepted_by="K. Ito", note="seen in three sessions", accepted_at=NOW,
)  # fmt: skip
OTHERS = {"alignment": alignment_bytes(unit="BA-017"), "rate table": rate_table_bytes(unit="BA-017")}
OTHERS["recording"] = recording_bytes()


def stored(storage: Storage, content: bytes) -> str:
    """The id of an upload."""
    return upload(storage, content, "a.json", NOW).id


def accepted(storage: Storage, session: str) -> None:
    """A cause of A3 in the unit's model."""
    with storage.database.writing() as store:
        Models(store).add(replace(CUBIC, session=session))


@pytest.mark.parametrize("programme", ["rate table", "recording"])
def test_causes_are_not_looked_for_and_that_is_no_failure(storage: Storage, programme: str) -> None:
    stored(storage, session_bytes())
    found = diagnose(storage, stored(storage, OTHERS[programme]), NOW)
    assert found.state is DiagnosisState.NOT_APPLICABLE
    assert found.summary.startswith("Not applicable to this programme")


@pytest.mark.parametrize("programme", ["rate table", "recording"])
def test_pages_and_answers_say_so(holding: Holding, programme: str) -> None:
    client, id = holding(session_bytes(), OTHERS[programme]), session_id(OTHERS[programme])
    answer = client.get(f"/api/v1/sessions/{id}/diagnosis")
    document = answer.json()
    assert answer.status_code == 200
    assert (document["state"], document["findings"], document["gain"]) == ("not applicable", [], None)
    for page in (f"/sessions/{id}", f"/sessions/{id}/diagnosis"):
        assert "Not applicable to this programme" in client.get(page).text


def test_a_lever_arm_is_said_on_the_pages_and_by_the_api(holding: Holding) -> None:
    content = alignment_bytes(a2_stands=(0.04, -0.03))
    client, id = holding(content, diagnosed=True), session_id(content)
    for page in (f"/sessions/{id}", f"/sessions/{id}/diagnosis"):
        assert re.search(r"A2 is [45]\.\d ± 0\.\d cm from the turn axis", client.get(page).text)
    document = client.get(f"/api/v1/sessions/{id}/diagnosis").json()
    assert [finding["cause"] for finding in document["findings"]] == ["lever-arm"]
    assert "Parts of the turn held out" in client.get(f"/sessions/{id}/diagnosis").text


def test_a_sound_alignment_has_nothing_wrong(storage: Storage) -> None:
    found = diagnose(storage, stored(storage, OTHERS["alignment"]), NOW)
    assert found.state is DiagnosisState.NOTHING


def test_an_alignment_neither_raises_nor_clears_a_flag(storage: Storage) -> None:
    cubic = drawn(TEMPERATURE).session | {"started_at": "2026-01-05T08:00:00Z"}
    diagnose(storage, stored(storage, json.dumps(cubic).encode()), NOW)
    diagnose(storage, stored(storage, alignment_bytes(unit=cubic["unit"], month=6, a2_stands=(0.04, -0.03))), NOW)
    with storage.database.reading() as store:
        open_now = Flags(store).open_of(Units(store).key(cubic["unit"]))
    assert [flag.matter for flag in open_now] == [Matter.CAUSE]


@pytest.mark.slow
def test_recordings_between_two_calibrations_do_not_hide_the_earlier_one(storage: Storage) -> None:
    first = stored(storage, session_bytes())
    for seed in range(12):
        stored(storage, recording_bytes(seed=seed, seconds=20))
    last = stored(storage, session_bytes(seed=2, month=6))
    with storage.database.reading() as store:
        assert [past.id for past in task_of(store, last).earlier] == [first]


def test_a_recording_is_compared_again_with_the_reference_under_its_new_model(storage: Storage) -> None:
    reference, recording = stored(storage, session_bytes()), stored(storage, recording_bytes(a3_moved=400.0))
    accepted(storage, reference)
    done = recalibrate(storage, "BA-017", NOW)
    assert (done.recomputed, done.left) == (2, 0)
    with storage.database.reading() as store:
        assert Calibrations(store).revisions(recording) == (0, 1)
        before, after = (Calibrations(store).get(recording, revision) for revision in (0, 1))
        assert Sessions(store).get(recording).verdict is Verdict.FAIL
    assert before.parity is not None
    assert after.parity is not None
    assert after.parity["isolated"] == "A3"
    assert before.parity["chi2"] != after.parity["chi2"]


@pytest.mark.parametrize("programme", ["alignment", "rate table"])
def test_no_accepted_cause_changes_what_is_no_calibration(storage: Storage, programme: str) -> None:
    reference, other = stored(storage, session_bytes()), stored(storage, OTHERS[programme])
    accepted(storage, reference)
    done = recalibrate(storage, "BA-017", NOW)
    assert (done.recomputed, done.unchanged) == (1, 1)
    with storage.database.reading() as store:
        assert Calibrations(store).revisions(other) == (0,)


def test_a_programme_that_nobody_entered_anywhere_rests_on_no_model() -> None:
    known = {programme: rests_on_model(programme) for programme in (*PROGRAMMES, "two-point")}
    assert [programme for programme, rests in known.items() if rests] == [*CALIBRATIONS, IN_SERVICE]
