"""Stored sessions are diagnosed once; accepted causes become models; recomputing overwrites nothing."""

import json
from collections.abc import Callable
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from threading import Event

import pytest
from sqlalchemy import text

from service.background.diagnose_pending import diagnose_pending
from service.errors import ConflictError, NotFoundError, RefusedError
from service.flows.accept_model import accept_model
from service.flows.diagnose import QUICK_BYTES, InProgress, diagnose, diagnose_now_or_later
from service.flows.recalibrate import recalibrate
from service.flows.receive import upload
from service.flows.withdraw_model import withdraw_model
from service.records.diagnosis import DiagnosisState
from service.records.model import NewModel, Scope
from service.storage import Storage
from service.storage.queries.history import HistoryQuery
from tests.service.diagnosed import ECCENTRIC, TEMPERATURE, drawn
from tests.service.sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
WARM = drawn(TEMPERATURE).session
ACCEPT = NewModel("bias-temperature", Scope.UNIT, "K. Ito", "seen twice")


def stored(storage: Storage, **changes: object) -> str:
    """The id of a stored session in which A5 follows the temperature."""
    return upload(storage, json.dumps(WARM | changes).encode(), "warm.json", NOW).id


def test_a_session_is_diagnosed_once(storage: Storage) -> None:
    id = stored(storage)
    first = diagnose(storage, id, NOW)
    assert (first.state, first.summary) == (DiagnosisState.NAMED, "The zero of A5 follows the temperature.")
    assert diagnose(storage, id, NOW + timedelta(days=1)) == first


def test_a_session_that_does_not_exist_is_not_found(storage: Storage) -> None:
    with pytest.raises(NotFoundError):
        diagnose(storage, "none", NOW)


def test_what_a_crash_interrupted_is_diagnosed_at_the_next_start(storage: Storage) -> None:
    ids = [stored(storage, notes=str(k)) for k in range(2)]
    diagnose_pending(storage, lambda: NOW, InProgress(), Event())
    with storage.database.reading() as store:
        assert all(store.diagnoses.exists(id) for id in ids)
        assert store.sessions.without_diagnosis("", 10, "") == ()


def test_a_large_session_is_left_for_later(storage: Storage) -> None:
    content = json.dumps(WARM, indent=100).encode()
    assert len(content) > QUICK_BYTES
    id = upload(storage, content, "large.json", NOW).id
    later: list[str] = []
    assert diagnose_now_or_later(storage, id, NOW, later.append) is None
    assert later == [id]


def test_one_session_is_not_diagnosed_twice_at_once() -> None:
    progress = InProgress()
    with progress.claim("a") as first, progress.claim("a") as second:
        assert (first, second) == (True, False)
    with progress.claim("a") as again:
        assert again


def test_the_next_session_is_calibrated_with_the_accepted_cause(storage: Storage) -> None:
    id = stored(storage)
    revision = accept_model(storage, diagnose(storage, id, NOW), ACCEPT, NOW)
    assert (revision.id, revision.subject, revision.sensors) == (1, WARM["unit"], ("A5",))
    assert revision.evidence.gain.after.chi2_per_dof < revision.evidence.gain.before.chi2_per_dof
    later = stored(storage, started_at="2026-08-01T09:00:00Z")
    with storage.database.reading() as store:
        assert store.sessions.get(later).revision == 1
        assert store.calibrations.get(later).fit.chi2 < store.calibrations.get(id).fit.chi2 / 2


@pytest.mark.parametrize("scope", [Scope.UNIT, Scope.UNIT_TYPE])
def test_a_model_is_for_its_scope_alone(storage: Storage, scope: Scope) -> None:
    accept_model(storage, diagnose(storage, stored(storage), NOW), replace(ACCEPT, scope=scope), NOW)
    other = stored(storage, unit="ANOTHER")
    with storage.database.reading() as store:
        assert store.sessions.get(other).revision == (1 if scope is Scope.UNIT_TYPE else 0)


def test_a_stand_s_cause_is_in_the_model_of_whatever_it_measures(storage: Storage) -> None:
    document = drawn(ECCENTRIC).session
    id = upload(storage, json.dumps(document).encode(), "a.json", NOW).id
    new = NewModel("beta-scale", Scope.STAND, "K. Ito", "")
    assert accept_model(storage, diagnose(storage, id, NOW), new, NOW).subject == document["stand"]["id"]
    other = upload(storage, session_bytes(stand=WARM["stand"] | {"id": document["stand"]["id"]}), "b.json", NOW).id
    with storage.database.reading() as store:
        assert store.sessions.get(other).revision == 1


REFUSED: dict[str, tuple[NewModel, str]] = {
    "not shown": (replace(ACCEPT, cause="hysteresis"), "cause"),
    "one sensor, for a stand": (replace(ACCEPT, scope=Scope.STAND), "scope"),
}


@pytest.mark.parametrize("why", REFUSED)
def test_what_cannot_be_accepted_is_refused_with_its_field(storage: Storage, why: str) -> None:
    new, field = REFUSED[why]
    with pytest.raises(RefusedError) as refused:
        accept_model(storage, diagnose(storage, stored(storage), NOW), new, NOW)
    assert [problem.field for problem in refused.value.problems] == [field]


def test_recomputing_adds_a_calibration_and_overwrites_none(storage: Storage) -> None:
    id = stored(storage)
    with storage.database.reading() as store:
        before = store.calibrations.json(id)
    accept_model(storage, diagnose(storage, id, NOW), ACCEPT, NOW)
    done = recalibrate(storage, WARM["unit"], NOW)
    assert (done.sessions, done.recomputed, done.revision) == (1, 1, 1)
    assert recalibrate(storage, WARM["unit"], NOW).unchanged == 1
    with storage.database.reading() as store:
        assert store.calibrations.revisions(id) == (0, 1)
        assert store.calibrations.json(id, 0) == before
        assert store.calibrations.json(id) == store.calibrations.json(id, 1) != before


def test_the_history_can_be_read_under_an_earlier_revision(storage: Storage) -> None:
    accept_model(storage, diagnose(storage, stored(storage), NOW), ACCEPT, NOW)
    recalibrate(storage, WARM["unit"], NOW)
    with storage.database.reading() as store:
        unit = store.units.key(WARM["unit"])
        found = {revision: points_of(store.history.points, unit, revision) for revision in (None, 0, 1)}
    assert found[None] == found[1] != found[0]
    assert {point.revision for point in found[0]} == {0}


def points_of(points: Callable[..., tuple], unit: int, revision: int | None) -> tuple:
    """The history under a revision."""
    return points(unit, HistoryQuery(revision=revision))


def test_every_step_is_in_the_audit(storage: Storage) -> None:
    id = stored(storage)
    accept_model(storage, diagnose(storage, id, NOW), ACCEPT, NOW)
    recalibrate(storage, WARM["unit"], NOW, who="R. Duarte")
    with storage.database.engine.connect() as connection:
        lines = connection.execute(text("SELECT who, action FROM audit ORDER BY id")).all()
    assert [tuple(line) for line in lines] == [
        ("crew", "upload"),
        ("diagnosis", "diagnose"),
        ("K. Ito", "accept model"),
        ("R. Duarte", "recalibrate"),
    ]


def test_a_diagnosis_that_another_version_failed_to_make_is_made_again(storage: Storage) -> None:
    id = stored(storage)
    made = diagnose(storage, id, NOW)
    with storage.database.writing() as store:
        store.diagnoses.add_once(replace(made, estimator_version="later"))
    assert diagnose(storage, id, NOW) == made
    spoil(storage, id, estimator_version="0.0.1")
    with storage.database.reading() as store:
        assert store.sessions.without_diagnosis("", 10, made.estimator_version) == (id,)
    assert diagnose(storage, id, NOW) == made
    spoil(storage, id, estimator_version=made.estimator_version)
    assert diagnose(storage, id, NOW).state is DiagnosisState.FAILED


def spoil(storage: Storage, id: str, *, estimator_version: str) -> None:
    """Makes the stored diagnosis one that a version failed to make."""
    changed = text("UPDATE diagnoses SET state = 'failed', estimator_version = :version WHERE session_id = :id")
    with storage.database.engine.begin() as connection:
        connection.execute(changed, {"version": estimator_version, "id": id})


def test_a_withdrawn_cause_is_out_of_the_model_and_nothing_is_lost(storage: Storage) -> None:
    id = stored(storage)
    accepted = accept_model(storage, diagnose(storage, id, NOW), ACCEPT, NOW)
    recalibrate(storage, WARM["unit"], NOW)
    withdrawn = withdraw_model(storage, accepted.id, "R. Duarte", "the thermometer was at fault", NOW)
    assert (withdrawn.withdraws, withdrawn.cause) == (accepted.id, accepted.cause)
    later = stored(storage, notes="after the withdrawal", started_at="2026-11-20T08:00:00Z")
    again = recalibrate(storage, WARM["unit"], NOW)
    assert (again.recomputed, again.revision) == (1, withdrawn.id)
    with storage.database.reading() as store:
        assert store.sessions.get(later).revision == withdrawn.id
        baseline, extended, now = (store.calibrations.get(id, r) for r in (0, accepted.id, withdrawn.id))
    assert now.fit.chi2 == baseline.fit.chi2 > extended.fit.chi2


def test_what_is_not_in_force_cannot_be_withdrawn(storage: Storage) -> None:
    accepted = accept_model(storage, diagnose(storage, stored(storage), NOW), ACCEPT, NOW)
    withdrawn = withdraw_model(storage, accepted.id, "R. Duarte", "a mistake", NOW)
    for revision in (accepted.id, withdrawn.id):
        with pytest.raises(ConflictError):
            withdraw_model(storage, revision, "R. Duarte", "again", NOW)
    with pytest.raises(NotFoundError):
        withdraw_model(storage, 10**6, "R. Duarte", "none", NOW)
