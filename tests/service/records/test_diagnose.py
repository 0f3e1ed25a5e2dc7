"""Stored sessions are diagnosed once; accepted causes become models; recomputing overwrites nothing."""

import json
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import text

from service.diagnosis.store import Diagnoses
from service.errors import ConflictError, NotFoundError, RefusedError
from service.models.records import ModelRevision, NewModel, Scope
from service.records.diagnose import diagnose
from service.records.models import accept_model, withdraw_model
from service.records.recalibrate import recalibrate
from service.sessions.calibrations_store import Calibrations
from service.sessions.history_store import History, HistoryQuery
from service.sessions.records import DiagnosisState
from service.sessions.store import Sessions
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from tests.builders import accelerometer_block, true_sensors
from tests.conftest import SettingsHolding
from tests.service.diagnosed import ECCENTRIC, TEMPERATURE, drawn
from tests.service.made_sessions import session_bytes, session_id
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
WARM = drawn(TEMPERATURE).session
CONTENT = json.dumps(WARM).encode()
ID = session_id(CONTENT)
ACCEPT = NewModel("bias-temperature", Scope.UNIT, "K. Ito", "seen twice")


def stored(storage: Storage, **changes: object) -> str:
    """The id of a stored session in which A5 follows the temperature."""
    return upload(storage, json.dumps(WARM | changes).encode(), "warm.json", NOW).id


@pytest.fixture
def warm(settings_holding: SettingsHolding) -> Iterator[Storage]:
    """Stores that hold the session with its diagnosis."""
    with stores(settings_holding(CONTENT, diagnosed=True)) as found:
        yield found


def accept(storage: Storage, new: NewModel = ACCEPT) -> ModelRevision:
    """The model revision since a cause of the session was accepted."""
    return accept_model(storage, diagnose(storage, ID, NOW), new, NOW)


def test_a_session_is_diagnosed_once(storage: Storage) -> None:
    id = stored(storage)
    first = diagnose(storage, id, NOW)
    assert (first.state, first.summary) == (DiagnosisState.NAMED, "The bias of A5 depends on temperature.")
    assert diagnose(storage, id, NOW + timedelta(days=1)) == first


def test_the_reference_itself_is_not_judged_again_and_a_later_session_is(storage: Storage) -> None:
    reference, later = stored(storage), stored(storage, started_at="2026-09-01T09:00:00Z")
    made = [diagnose(storage, id, NOW) for id in (reference, later)]
    assert [diagnosis.state for diagnosis in made] == [DiagnosisState.NAMED] * 2
    assert made[0].verdict_after is None
    assert made[1].verdict_after is not None


@pytest.mark.parametrize(("prefix", "reason"), [("A", ""), ("B", "the session lacks history")])
def test_only_sessions_of_the_same_sensors_are_a_history(storage: Storage, prefix: str, reason: str) -> None:
    for month, names in ((1, "A"), (2, prefix)):
        block = accelerometer_block(sensors=true_sensors(prefix=names, bias=1e-3), seed=month)
        content = json.dumps(block | {"started_at": f"2026-0{month}-01T09:00:00Z"}).encode()
        id = upload(storage, content, "a.json", NOW).id
    found = diagnose(storage, id, NOW).found
    assert found is not None
    assert [limit.reason for limit in found.limits if limit.cause == "sensor-drift"] == [reason]


def test_a_session_that_does_not_exist_is_not_found(storage: Storage) -> None:
    with pytest.raises(NotFoundError):
        diagnose(storage, "none", NOW)


def test_the_next_session_is_calibrated_with_the_accepted_cause(warm: Storage) -> None:
    revision = accept(warm)
    assert (revision.id, revision.subject, revision.sensors) == (1, WARM["unit"], ("A5",))
    assert revision.evidence.gain.after.chi2_per_dof < revision.evidence.gain.before.chi2_per_dof
    later = stored(warm, started_at="2026-08-01T09:00:00Z")
    with warm.database.reading() as store:
        assert Sessions(store).get(later).revision == 1
        assert Calibrations(store).get(later).fit.chi2 < Calibrations(store).get(ID).fit.chi2 / 2


@pytest.mark.parametrize("scope", [Scope.UNIT, Scope.UNIT_TYPE])
def test_a_model_is_for_its_scope_alone(warm: Storage, scope: Scope) -> None:
    accept(warm, replace(ACCEPT, scope=scope))
    other = stored(warm, unit="ANOTHER")
    with warm.database.reading() as store:
        assert Sessions(store).get(other).revision == (1 if scope is Scope.UNIT_TYPE else 0)


def test_a_stand_s_cause_is_in_the_model_of_whatever_it_measures(storage: Storage) -> None:
    document = drawn(ECCENTRIC).session
    id = upload(storage, json.dumps(document).encode(), "a.json", NOW).id
    new = NewModel("beta-scale", Scope.STAND, "K. Ito", "")
    assert accept_model(storage, diagnose(storage, id, NOW), new, NOW).subject == document["stand"]["id"]
    other = upload(storage, session_bytes(stand=WARM["stand"] | {"id": document["stand"]["id"]}), "b.json", NOW).id
    with storage.database.reading() as store:
        assert Sessions(store).get(other).revision == 1


REFUSED: dict[str, tuple[NewModel, str]] = {
    "not shown": (replace(ACCEPT, cause="hysteresis"), "cause"),
    "one sensor, for a stand": (replace(ACCEPT, scope=Scope.STAND), "scope"),
}


@pytest.mark.parametrize("why", REFUSED)
def test_what_cannot_be_accepted_is_refused_with_its_field(warm: Storage, why: str) -> None:
    new, field = REFUSED[why]
    with pytest.raises(RefusedError) as refused:
        accept(warm, new)
    assert [problem.field for problem in refused.value.problems] == [field]


def test_recomputing_adds_a_calibration_and_overwrites_none(warm: Storage) -> None:
    with warm.database.reading() as store:
        before = Calibrations(store).json(ID)
    accept(warm)
    done = recalibrate(warm, WARM["unit"], NOW)
    assert (done.sessions, done.recomputed, done.revision) == (1, 1, 1)
    assert recalibrate(warm, WARM["unit"], NOW).unchanged == 1
    with warm.database.reading() as store:
        assert Calibrations(store).revisions(ID) == (0, 1)
        assert Calibrations(store).json(ID, 0) == before
        assert Calibrations(store).json(ID) == Calibrations(store).json(ID, 1) != before


def test_the_history_can_be_read_under_an_earlier_revision(warm: Storage) -> None:
    accept(warm)
    recalibrate(warm, WARM["unit"], NOW)
    with warm.database.reading() as store:
        unit = Units(store).key(WARM["unit"])
        found = {revision: points_of(History(store).points, unit, revision) for revision in (None, 0, 1)}
    assert found[None] == found[1] != found[0]
    assert {point.revision for point in found[0]} == {0}


def points_of(points: Callable[..., tuple], unit: int, revision: int | None) -> tuple:
    """The history under a revision."""
    return points(unit, HistoryQuery(revision=revision))


def test_every_step_is_in_the_audit(warm: Storage) -> None:
    accept(warm)
    recalibrate(warm, WARM["unit"], NOW, who="R. Duarte")
    with warm.database.engine.connect() as connection:
        lines = connection.execute(text("SELECT who, action FROM audit ORDER BY id")).all()
    assert [tuple(line) for line in lines] == [
        ("crew", "upload"),
        ("diagnosis", "diagnose"),
        ("K. Ito", "accept model"),
        ("R. Duarte", "recalibrate"),
    ]


def test_a_diagnosis_that_another_version_failed_to_make_is_made_again(warm: Storage) -> None:
    made = diagnose(warm, ID, NOW)
    with warm.database.writing() as store:
        Diagnoses(store).add_once(replace(made, estimator_version="later"))
    assert diagnose(warm, ID, NOW) == made
    spoil(warm, ID, estimator_version="0.0.1")
    with warm.database.reading() as store:
        assert Sessions(store).without_diagnosis("", 10, made.estimator_version) == (ID,)
    assert replace(diagnose(warm, ID, NOW), created_at=made.created_at) == made
    spoil(warm, ID, estimator_version=made.estimator_version)
    assert diagnose(warm, ID, NOW).state is DiagnosisState.FAILED


def spoil(storage: Storage, id: str, *, estimator_version: str) -> None:
    """Makes the stored diagnosis one that a version failed to make."""
    changed = text("UPDATE diagnoses SET state = 'failed', estimator_version = :version WHERE session_id = :id")
    with storage.database.engine.begin() as connection:
        connection.execute(changed, {"version": estimator_version, "id": id})


def test_a_withdrawn_cause_is_out_of_the_model_and_nothing_is_lost(warm: Storage) -> None:
    accepted = accept(warm)
    recalibrate(warm, WARM["unit"], NOW)
    withdrawn = withdraw_model(warm, accepted.id, "R. Duarte", "the thermometer was at fault", NOW)
    assert (withdrawn.withdraws, withdrawn.cause) == (accepted.id, accepted.cause)
    later = stored(warm, notes="after the withdrawal", started_at="2026-11-20T08:00:00Z")
    again = recalibrate(warm, WARM["unit"], NOW)
    assert (again.recomputed, again.revision) == (1, withdrawn.id)
    with warm.database.reading() as store:
        assert Sessions(store).get(later).revision == withdrawn.id
        baseline, extended, now = (Calibrations(store).get(ID, r) for r in (0, accepted.id, withdrawn.id))
    assert now.fit.chi2 == baseline.fit.chi2 > extended.fit.chi2


def test_what_is_not_in_force_cannot_be_withdrawn(warm: Storage) -> None:
    accepted = accept(warm)
    withdrawn = withdraw_model(warm, accepted.id, "R. Duarte", "a mistake", NOW)
    for revision in (accepted.id, withdrawn.id):
        with pytest.raises(ConflictError):
            withdraw_model(warm, revision, "R. Duarte", "again", NOW)
    with pytest.raises(NotFoundError):
        withdraw_model(warm, 10**6, "R. Duarte", "none", NOW)
