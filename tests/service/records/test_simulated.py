"""Simulated sessions say so, and say nothing of what was measured."""

import pytest

from service.errors import ConflictError, RefusedError
from service.fleet.store import Fleet
from service.groups.store import Groups
from service.papers.changes import Signing, SigningRules, Statement, signature_of
from service.papers.records import Meaning
from service.records.changes import accept_session, withdraw_session
from service.stands.health import stand_health
from service.stands.store import Stands
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import one_engine
from tests.service.made_records import NOW, step, way
from tests.service.made_sessions import session_bytes

SIMULATED = {"origin": "simulated"}


def sent(storage: Storage, *, unit: str = "BA-017", month: int = 3, **changes: str) -> str:
    return upload(storage, session_bytes(unit=unit, month=month, **changes), "a.json", NOW).id


@one_engine
@pytest.mark.parametrize(("first", "second"), [({}, SIMULATED), (SIMULATED, {})])
def test_a_unit_is_measured_or_simulated(storage: Storage, first: dict[str, str], second: dict[str, str]) -> None:
    sent(storage, **first)
    with pytest.raises(RefusedError) as refused:
        sent(storage, month=4, **second)
    (problem,) = refused.value.problems
    assert (problem.field, "its own serial number" in problem.message) == ("origin", True)


def test_a_unit_is_measured_once_what_was_simulated_is_withdrawn(storage: Storage) -> None:
    simulated = sent(storage, **SIMULATED)
    withdraw_session(storage, way(storage), simulated, step("a trial"))
    sent(storage, month=4)
    with storage.database.reading() as store:
        assert Fleet(store).condition().simulated == 0
    with pytest.raises(ConflictError, match="has been measured since"):
        accept_session(storage, way(storage), simulated, step("a slip"))


@one_engine
def test_a_file_that_says_measured_is_the_one_that_says_nothing(storage: Storage) -> None:
    assert sent(storage) == sent(storage, origin="measured")


def test_a_simulated_unit_tells_nothing_of_a_stand_with_measured_ones(storage: Storage) -> None:
    sent(storage, unit="SIM-1", **SIMULATED)
    with storage.database.reading() as store:
        assert {motion.unit for motion in Stands(store).motions()} == {"SIM-1"}
        assert stand_health(store)
    sent(storage)
    with storage.database.reading() as store:
        assert {motion.unit for motion in Stands(store).motions()} == {"BA-017"}
        of_type = Groups(store).of_unit("SIM-1")[1:]
        assert {member.unit for group in of_type for member in Groups(store).members(group, None).sessions} == {
            "BA-017"
        }


@one_engine
def test_nobody_signs_for_what_was_simulated(storage: Storage) -> None:
    specimen = Statement("BA-017", sent(storage, **SIMULATED), 0, "", is_specimen=True)
    signing = Signing(specimen.session, "specimen-1", Meaning.REVIEWED, "engineer", "a password")
    with storage.database.reading() as store, pytest.raises(ConflictError, match="a specimen"):
        signature_of(store, signing, specimen, SigningRules(), NOW)
