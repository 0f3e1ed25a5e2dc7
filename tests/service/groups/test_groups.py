"""Groups of the sessions of a unit, a type and a stand: the sessions that count, and when a group is made anew."""

import json
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest

from estimator.diagnosis import diagnose as find_causes
from service.errors import RefusedError
from service.flags.records import Matter
from service.flags.store import Flags
from service.groups.records import Group, GroupAnswer, Level
from service.groups.store import GIVEN_UP, MOST_ATTEMPTS, Groups, Statistics
from service.ingest import read_upload
from service.models.records import NewModel, Scope
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.changes import accept_session, record_service, withdraw_session
from service.records.diagnose import diagnose
from service.records.models import accept_model
from service.records.refresh_group import current, members_of, refresh_group
from service.sessions.store import Sessions
from service.settings import VERSION
from service.storage import Storage
from service.units.records import NewService
from service.units.store import Units
from service.uploads.receive import upload
from tests.conftest import Filled
from tests.databases import one_engine
from tests.service.grouped import GROUP, cubic_session
from tests.service.made_records import step, way
from tests.service.made_sessions import session_id

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
UNIT = "BA-017"


def fill(storage: Storage, *contents: bytes) -> None:
    for content in contents:
        upload(storage, content, "a.json", NOW)


def group(storage: Storage, level: Level = Level.UNIT, name: str = UNIT) -> Group:
    with storage.database.reading() as store:
        return Groups(store).find(level, name)


def refreshed(storage: Storage, level: Level = Level.UNIT, name: str = UNIT) -> GroupAnswer:
    return refresh_group(storage, group(storage, level, name), NOW)


def told(answer: GroupAnswer) -> dict[str, Any]:
    document: dict[str, Any] = json.loads(answer.document or "null")
    return document


def holds(storage: Storage) -> bool:
    """Whether the stored answer of the unit is up to date."""
    with storage.database.reading() as store:
        return current(store, Groups(store).find(Level.UNIT, UNIT)) is not None


def twelve(storage: Storage) -> None:
    fill(storage, *GROUP)


def twelve_with_the_last_diagnosed(storage: Storage) -> None:
    twelve(storage)
    diagnose(storage, session_id(GROUP[-1]), NOW)


def four_looked_at(storage: Storage) -> None:
    fill(storage, *GROUP[:4])
    refreshed(storage)


def test_twelve_sessions_name_what_none_of_them_shows(filled: Filled) -> None:
    found = told(refreshed(filled(twelve)))
    assert [(f["cause"], f["sensors"]) for f in found["findings"]] == [("cubic-nonlinearity", ["A2"])]
    assert (found["sessions"], len(found["findings"][0]["sessions"]), found["left_out"]) == (12, 12, 0)


@pytest.mark.slow
def test_hardly_any_of_the_twelve_shows_anything_alone() -> None:
    shown = [find_causes(read_upload(content, "a.json")).findings for content in GROUP]
    assert sum(bool(findings) for findings in shown) <= 1  # the faintest effects are named, if seldom


@pytest.mark.slow
@one_engine
def test_the_twelfth_is_diagnosed_by_the_evidence_of_all(filled: Filled) -> None:
    storage = filled(twelve)
    diagnose(storage, session_id(GROUP[0]), NOW)  # its record is kept, and so it counts beyond the ten before
    made = diagnose(storage, session_id(GROUP[-1]), NOW)
    assert made.found is not None
    (finding,) = made.found.findings
    assert (finding.cause, finding.sensors) == ("cubic-nonlinearity", ("A2",))
    assert finding.over_sessions is not None
    assert finding.over_sessions.sessions == 12


@pytest.mark.slow
@one_engine
def test_a_flag_is_raised_by_all_sessions_together_and_not_by_the_one_that_was_diagnosed_so(filled: Filled) -> None:
    with filled(twelve_with_the_last_diagnosed).database.reading() as store:
        assert not [flag for flag in Flags(store).open_of(Units(store).key(UNIT)) if flag.matter is Matter.CAUSE]


@one_engine
def test_what_all_sessions_show_is_not_accepted_from_one(filled: Filled) -> None:
    storage = filled(twelve_with_the_last_diagnosed)
    made = diagnose(storage, session_id(GROUP[-1]), NOW)
    with pytest.raises(RefusedError):
        accept_model(storage, made, NewModel("cubic-nonlinearity", Scope.UNIT, "K. Ito", ""), NOW)


@pytest.mark.parametrize(("level", "name"), [(Level.TYPE, "three"), (Level.STAND, "ODG-1")])
def test_a_type_and_a_stand_have_the_sessions_of_all_their_units(storage: Storage, level: Level, name: str) -> None:
    fill(storage, *GROUP[:2], cubic_session(2, unit="BA-018"))
    found = told(refreshed(storage, level, name))
    assert (found["level"], found["id"], found["sessions"]) == (level.value, name, 3)


def test_to_a_stand_come_its_units_elsewhere_before_its_last_session(storage: Storage) -> None:
    documents = [json.loads(content) for content in GROUP[:4]]
    for k in (0, 3):
        documents[k]["stand"]["id"] = "ODG-2"
    fill(storage, *(json.dumps(document).encode() for document in documents))
    assert (told(refreshed(storage, Level.STAND, "ODG-1"))["sessions"], told(refreshed(storage))["sessions"]) == (3, 4)


def test_a_session_that_is_withdrawn_leaves_and_comes_back_when_it_is_accepted(filled: Filled) -> None:
    storage = filled(four_looked_at)
    before, last = refreshed(storage), session_id(GROUP[3])
    withdraw_session(storage, way(storage), last, step())
    assert not holds(storage)
    assert told(refreshed(storage))["sessions"] == 3
    accept_session(storage, way(storage), last, step())
    assert told(refreshed(storage)) == told(before)


def test_a_unit_is_pooled_since_its_last_service(filled: Filled) -> None:
    storage = filled(four_looked_at)
    record_service(storage, UNIT, NewService("repair", datetime(2023, 2, 15, tzinfo=UTC)), NOW)
    assert told(refreshed(storage))["first"].startswith("2023-03")


def test_it_is_made_once_while_its_sessions_stay_the_same(storage: Storage) -> None:
    fill(storage, *GROUP[:2])
    refreshed(storage)
    again = refresh_group(storage, group(storage), NOW + timedelta(days=1))
    assert again.created_at == NOW
    fill(storage, GROUP[2])
    assert refresh_group(storage, group(storage), NOW + timedelta(days=1)).created_at > NOW


def test_the_statistics_of_a_session_are_made_with_its_diagnosis(storage: Storage) -> None:
    fill(storage, GROUP[0])
    id = session_id(GROUP[0])
    diagnose(storage, id, NOW)
    with storage.database.reading() as store:
        assert Statistics(store).of([id])[id].sensors == ("A1", "A2", "A3")


@one_engine
def test_every_change_of_a_record_asks_for_its_groups(storage: Storage) -> None:
    fill(storage, GROUP[0])
    for level, name in ((Level.UNIT, UNIT), (Level.TYPE, "three"), (Level.STAND, "ODG-1")):
        refreshed(storage, level, name)
    withdraw_session(storage, way(storage), session_id(GROUP[0]), step())
    with storage.database.reading() as store:
        assert {Groups(store).at(place).name for place in WorkQueue(store, WorkKind.GROUP).waiting(NOW, 10)} == {
            UNIT,
            "three",
            "ODG-1",
        }


@one_engine
def test_a_lost_file_is_left_out_and_named(storage: Storage) -> None:
    fill(storage, *GROUP[:3])
    file_of(storage, session_id(GROUP[1])).unlink()
    found = told(refreshed(storage))
    assert (found["sessions"], [one["session"] for one in found["not_pooled"]]) == (2, [session_id(GROUP[1])])


def file_of(storage: Storage, id: str) -> Path:
    with storage.database.reading() as store:
        sha256 = Sessions(store).get(id).sha256
    return next(storage.files.folder.rglob(f"{sha256}*"))


@one_engine
def test_a_group_without_a_session_says_so(storage: Storage) -> None:
    fill(storage, GROUP[0])
    withdraw_session(storage, way(storage), session_id(GROUP[0]), step())
    answer = refreshed(storage)
    assert (told(answer)["sessions"], answer.summary) == (0, "No accepted session calibrates a block.")


@one_engine
def test_only_the_newest_are_pooled_and_the_rest_is_counted(storage: Storage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.groups.store.MOST", 2)
    fill(storage, *GROUP[:3])
    found = told(refreshed(storage))
    assert (found["sessions"], found["left_out"], found["first"][:7]) == (2, 1, "2023-02")


def test_a_session_that_no_process_outlives_is_given_up(storage: Storage) -> None:
    fill(storage, GROUP[0])
    id = session_id(GROUP[0])
    for attempt in range(MOST_ATTEMPTS + 1):
        with storage.database.writing() as store:
            assert Statistics(store).begin(id, VERSION) is (attempt < MOST_ATTEMPTS)
    with storage.database.reading() as store:
        assert [m.why for m in members_of(store, group(storage)).without] == [GIVEN_UP]
    with storage.database.writing() as store:
        assert Statistics(store).begin(id, "the next one")
