"""A verdict carries what was found about its session, and only while that holds."""

import json
from collections.abc import Sequence
from datetime import UTC, datetime

import numpy as np
import pytest

from benchmarks.study.degrees_of_freedom import measured
from estimator.writing import session_document
from service.judging.reservations import UNCHECKED
from service.judging.words import ACCEPT, REPEAT, advice_on
from service.models.records import NewModel, Scope
from service.records.changes import choose_reference
from service.records.diagnose import diagnose
from service.records.models import accept_model
from service.records.recalibrate import recalibrate
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation, Reservations
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.files import content_hash
from service.uploads.receive import upload
from tests.databases import one_engine
from tests.service.diagnosed import boasting, swaying_stand
from tests.service.doubtful import CLAUSE, JUMPED, MISTAKEN, REFERENCE, SLIGHTLY, jumped
from tests.service.made_records import step, way
from tests.service.made_sessions import session_bytes, session_id

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def stored(storage: Storage, id: str) -> tuple[Verdict, Reservations]:
    """Stored verdict of a session, with its reservations."""
    with storage.database.reading() as store:
        session = Sessions(store).get(id)
    return session.verdict, session.reservations


def weighed(storage: Storage, contents: Sequence[bytes]) -> tuple[Verdict, tuple[Reservation, ...]]:
    """The verdict of the last of some sessions, with what it is said with."""
    for content in contents:
        id = upload(storage, content, "a.json", NOW).id
        diagnose(storage, id, NOW)
    verdict, reservations = stored(storage, id)
    assert reservations is not None
    return verdict, reservations


def test_a_named_cause_beyond_a_third_of_the_tolerance_is_a_reservation(storage: Storage) -> None:
    verdict, (reservation,) = weighed(storage, JUMPED)
    assert (verdict, reservation.kind) == (Verdict.PASS, Doubt.CAUSE)
    assert reservation.text.startswith(CLAUSE)
    assert (reservation.sensors, reservation.parameter) == (("A2",), "bias")
    assert reservation.share == pytest.approx(1.02, abs=0.3)


@one_engine
def test_a_cause_below_a_third_of_the_tolerance_leaves_the_verdict_plain(storage: Storage) -> None:
    assert weighed(storage, SLIGHTLY) == (Verdict.PASS, ())


@one_engine
def test_a_lost_file_leaves_the_verdict_unchecked_and_stops_nothing(storage: Storage) -> None:
    second = session_bytes(seed=2, month=2)
    weighed(storage, (REFERENCE, second))
    storage.files.path(content_hash(second)).unlink()
    choose_reference(storage, way(storage), session_id(second), step())
    assert stored(storage, session_id(second))[1] == UNCHECKED


@one_engine
def test_a_sound_session_has_a_plain_verdict(storage: Storage) -> None:
    assert weighed(storage, (REFERENCE, session_bytes(seed=2, month=2))) == (Verdict.PASS, ())


@one_engine
def test_a_verdict_that_is_another_with_the_named_cause_says_so(storage: Storage) -> None:
    verdict, reservations = weighed(storage, MISTAKEN)
    assert verdict is Verdict.CONDITIONAL_FAIL
    assert [r.verdict for r in reservations if r.kind is Doubt.OTHER_MODEL] == [Verdict.PASS]


def test_what_the_model_takes_care_of_is_no_reservation_any_more(storage: Storage) -> None:
    weighed(storage, MISTAKEN)
    made = diagnose(storage, session_id(MISTAKEN[-1]), NOW)
    accept_model(storage, made, NewModel("bias-jump", Scope.UNIT, "K. Ito", ""), NOW)
    recalibrate(storage, "BA-017", NOW)
    assert stored(storage, session_id(MISTAKEN[-1])) == (Verdict.PASS, ())


def test_until_causes_were_looked_for_nothing_is_known(storage: Storage) -> None:
    id = upload(storage, REFERENCE, "a.json", NOW).id
    assert stored(storage, id) == (Verdict.UNDECIDABLE, None)


@one_engine
def test_a_reference_that_jumped_is_told(storage: Storage) -> None:
    _, (reservation,) = weighed(storage, (jumped(51.0),))
    assert (reservation.kind, reservation.cause) == (Doubt.CAUSE, "bias-jump")


@one_engine
def test_a_file_that_is_wrong_is_told_first_and_is_to_be_corrected(storage: Storage) -> None:
    document = json.loads(session_bytes(seed=2, month=2))
    table = document["table"]
    table["A1"], table["A4"] = table["A4"], table["A1"]
    _, reservations = weighed(storage, (REFERENCE, json.dumps(document).encode()))
    assert reservations[0].kind is Doubt.RECORD
    assert reservations[0].advice == "correct the file and upload it again"


@one_engine
def test_a_session_with_nothing_left_to_look_in_was_not_checked(storage: Storage) -> None:
    bare, _ = measured(3, 9, False, np.random.default_rng(6))
    document = session_document(bare) | {"unit": "TRIAD-1", "started_at": "2026-03-05T08:00:00Z"}
    _, (reservation,) = weighed(storage, (json.dumps(document).encode(),))
    assert (reservation.kind, reservation.advice) == (Doubt.NOT_CHECKED, "add positions")


@one_engine
def test_large_structure_without_a_name_and_understated_errors_are_told(storage: Storage) -> None:
    _, (sways,) = weighed(storage, (json.dumps(swaying_stand()).encode(),))
    _, (boasts,) = weighed(storage, (json.dumps(boasting()).encode(),))
    assert (sways.kind, sways.sensors, sways.advice) == (
        Doubt.UNEXPLAINED, (), "correct the stand and repeat the session",
    )  # fmt: skip
    assert (boasts.kind, boasts.text) == (
        Doubt.STATED_ERRORS, "the stated standard errors are about 4 times too small",
    )  # fmt: skip


def test_a_property_of_the_sensor_is_accepted_or_repaired_and_no_session_is_repeated_for_it() -> None:
    assert advice_on("hysteresis") == advice_on("cubic-nonlinearity", "odd-quadratic") == ACCEPT
    assert "repeat" not in ACCEPT
    assert advice_on("bias-jump") == advice_on("hysteresis", "bias-jump") == REPEAT
    assert advice_on("levelling-y").startswith("correct the stand")
