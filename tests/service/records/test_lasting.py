"""An effect that a group of sessions shows is accepted into a model: every session it concerns is computed again, and
the changes are kept.
"""

import json
from dataclasses import replace
from datetime import UTC, datetime, timedelta

import pytest

from estimator import Calibration, calibrate, read_session
from service.errors import ConflictError, RefusedError
from service.fleet.wanted_store import Announcements
from service.groups.records import Group, Level
from service.groups.store import Groups
from service.models.records import ModelRevision, NewLasting, Progress, Recomputation, Scope
from service.models.rules import model_of
from service.models.store import Recomputations, evidence_from_dict, evidence_to_dict
from service.papers.certified import certified_session, laboratory_of
from service.papers.dcc import certificate_dcc
from service.papers.records import Issue
from service.papers.verifying.records import Outcome, RawFile
from service.papers.verifying.verify import Beside, verify
from service.records.diagnose import diagnose
from service.records.models import accept_lasting, withdraw_model
from service.records.recalibrate import recompute
from service.records.refresh_group import refresh_group
from service.sessions.calibrations_store import Calibrations
from service.sessions.records import SessionQuery
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.storage.audit import Audit
from service.uploads.receive import upload
from tests.conftest import Filled
from tests.databases import one_engine
from tests.service.grouped import CUBIC, cubic_session
from tests.service.made_sessions import session_id

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
LARGE = 4 * CUBIC
"""Plain in four sessions: fewer are quicker."""
GROUP = tuple(cubic_session(number, cubic=LARGE) for number in range(4))
UNIT, CAUSE = "BA-017", "cubic-nonlinearity"
NEW = NewLasting(CAUSE, (), "K. Ito", "seen on the bench")


def group(storage: Storage, level: Level = Level.UNIT, name: str = UNIT) -> Group:
    with storage.database.reading() as store:
        return Groups(store).find(level, name)


def scale(found: Calibration) -> float:
    """Scale of A2, which takes most of a cubic term for its own."""
    assert found.sensors[1].scale.value is not None
    return found.sensors[1].scale.value


def recompute_all(storage: Storage) -> None:
    with storage.database.reading() as store:
        waiting = Recomputations(store).waiting(NOW, 100)
    for task in waiting:
        recompute(storage, task, NOW, 2.0)


def brought(storage: Storage, revision: int) -> tuple[Recomputation, ...]:
    with storage.database.reading() as store:
        return Recomputations(store).of(revision)


def four_sessions(storage: Storage) -> None:
    """Stores four sessions of a unit, and one of another without the effect; the group's answer is made."""
    for content in (*GROUP, cubic_session(40, unit="BA-018", cubic=0.0)):
        upload(storage, content, "a.json", NOW)
    refresh_group(storage, group(storage), NOW)


@pytest.fixture
def four(filled: Filled) -> Storage:
    return filled(four_sessions)


@pytest.fixture
def accepted(four: Storage) -> ModelRevision:
    """The revision that holds the unit's cubic term, with its sessions computed again."""
    revision = accept_lasting(four, group(four), NEW, NOW)
    recompute_all(four)
    return revision


def test_every_session_of_the_unit_is_computed_again_with_the_group_s_size(
    four: Storage, accepted: ModelRevision
) -> None:
    assert (accepted.scope, accepted.subject, accepted.sensors) == (Scope.UNIT, UNIT, ("A2",))
    assert accepted.evidence is not None
    assert abs(accepted.evidence.amplitude[0] - LARGE) < 3 * accepted.evidence.sigma[0]
    with four.database.reading() as store:
        before, after = (scale(Calibrations(store).get(session_id(GROUP[0]), revision)) for revision in (0, None))
        assert {Sessions(store).get(session_id(c)).revision for c in GROUP} == {accepted.id}
        assert Sessions(store).wanted(SessionQuery(unit="BA-018", limit=1))[0].revision == 0
    sound = scale(calibrate(read_session(json.loads(cubic_session(0, cubic=0.0)))))
    assert abs(after - sound) < 0.1 * abs(before - sound)


def test_what_moved_is_kept(four: Storage, accepted: ModelRevision) -> None:
    (one,) = brought(four, accepted.id)
    assert (one.unit, one.state, one.done_at) == (UNIT, Progress.DONE, NOW)
    assert one.outcome is not None
    assert (one.outcome.sessions, one.outcome.recomputed, one.outcome.left) == (4, 4, 0)
    assert one.outcome.furthest is not None
    assert (one.outcome.furthest.sensor, one.outcome.furthest.change != 0) == ("A2", True)
    with four.database.reading() as store:
        lines = [line.action for line in Audit(store).page(20)]
    assert (lines.count("recalibrate"), lines.count("accept model")) == (4, 1)


@one_engine
def test_the_next_session_has_it_at_once(four: Storage, accepted: ModelRevision) -> None:
    later = upload(four, cubic_session(12, cubic=LARGE), "b.json", NOW).id
    with four.database.reading() as store:
        assert Sessions(store).get(later).revision == accepted.id


@one_engine
def test_its_certificate_can_be_computed_again(four: Storage, accepted: ModelRevision) -> None:
    id = session_id(GROUP[-1])
    found = certified_session(four, diagnose(four, id, NOW), laboratory_of(Settings()))
    assert found.model.fixed
    certificate = certificate_dcc(found, Issue("1", id, accepted.id, NOW, "", None, ""))
    checks = verify(certificate, RawFile("a.json", GROUP[-1]), Beside(), NOW)
    assert checks.outcome is Outcome.AGREES, checks


@one_engine
def test_withdrawn_it_goes_out_of_every_session_again(four: Storage, accepted: ModelRevision) -> None:
    first = session_id(GROUP[0])
    with four.database.reading() as store:
        plain = json.loads(Calibrations(store).json(first, 0))
    ended = withdraw_model(four, accepted.id, "R. Duarte", "the bench was tilted", NOW)
    recompute_all(four)
    with four.database.reading() as store:
        assert json.loads(Calibrations(store).json(first)) == plain
        assert Sessions(store).get(first).revision == ended.id
    assert [one.state for one in brought(four, ended.id)] == [Progress.DONE]


@one_engine
def test_it_is_accepted_for_the_sessions_of_now_alone(four: Storage) -> None:
    upload(four, cubic_session(12, cubic=LARGE), "b.json", NOW)
    with pytest.raises(ConflictError, match="being computed"):
        accept_lasting(four, group(four), NEW, NOW)


@one_engine
@pytest.mark.parametrize(
    ("new", "field"),
    [(NewLasting("hysteresis", (), "K. Ito", ""), "cause"), (NewLasting(CAUSE, ("A1",), "K. Ito", ""), "cause")],
)
def test_what_the_group_does_not_show_is_refused(four: Storage, new: NewLasting, field: str) -> None:
    with pytest.raises(RefusedError) as refused:
        accept_lasting(four, group(four), new, NOW)
    assert refused.value.problems[0].field == field


@one_engine
def test_a_type_s_and_a_stand_s_units_are_all_asked_for(four: Storage, accepted: ModelRevision) -> None:
    with four.database.writing() as store:
        assert Recomputations(store).ask(accepted.id, Scope.UNIT_TYPE, "three", NOW) == 2
        assert Recomputations(store).ask(accepted.id, Scope.STAND, "ODG-1", NOW) == 2
        assert Recomputations(store).ask(accepted.id, Scope.STAND, "ODG-9", NOW) == 0


@one_engine
def test_what_began_at_a_date_is_not_in_the_sessions_before(four: Storage, accepted: ModelRevision) -> None:
    revision = since(accepted, "2023-05-01T09:00:00Z")
    before, after = (model_of([revision], datetime(2023, month, 1, 12, tzinfo=UTC)) for month in (4, 5))
    assert (len(before.fixed), len(after.fixed)) == (0, 1)


@one_engine
def test_what_an_earlier_version_accepted_without_a_date_is_in_the_sessions_after_it(accepted: ModelRevision) -> None:
    undated = since(accepted, "")
    revision = replace(undated, evidence=evidence_from_dict(evidence_to_dict(undated.evidence)))
    before, after = (model_of([revision], NOW + timedelta(days)) for days in (-1, 1))
    assert (len(before.fixed), len(after.fixed)) == (0, 1)


def since(revision: ModelRevision, date: str) -> ModelRevision:
    assert revision.evidence is not None
    assert revision.evidence.pooled is not None
    pooled = replace(revision.evidence.pooled, form="since", since=date)
    return replace(revision, evidence=replace(revision.evidence, pooled=pooled))


@one_engine
def test_what_is_in_a_model_is_no_news_for_the_fleet_until_it_is_withdrawn(storage: Storage) -> None:
    four_sessions(storage)
    said = [told_of_fleet(storage)]
    revision = accept_lasting(storage, group(storage), NEW, NOW)
    said.append(told_of_fleet(storage))
    withdraw_model(storage, revision.id, "K. Ito", "mended", NOW)
    said.append(told_of_fleet(storage))
    assert said == [["BA-017"], [], ["BA-017"]]


@one_engine
def test_an_answer_that_is_made_again_knows_what_is_in_a_model(storage: Storage) -> None:
    four_sessions(storage)
    accept_lasting(storage, group(storage), NEW, NOW)
    upload(storage, cubic_session(5, cubic=LARGE), "a.json", NOW)
    refresh_group(storage, group(storage), NOW)
    assert told_of_fleet(storage) == []


def told_of_fleet(storage: Storage) -> list[str]:
    """Units whose sessions together show something new."""
    with storage.database.reading() as store:
        found = Announcements(store).all(0, 10).found
    return [one.group.name for one in found if one.group.level is Level.UNIT]
