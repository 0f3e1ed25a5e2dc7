"""Evidence of diagnoses on flags, one session after another: a matter closes when it is no longer found, and comes back
with it; a matter of a stand is one flag of the stand, from all sessions on it.
"""

from datetime import UTC, datetime
from itertools import permutations

import pytest
from sqlalchemy import update

from service.diagnosis.records import StoredDiagnosis
from service.diagnosis.store import Diagnoses
from service.flags.changes import resolve_flag
from service.flags.records import Concern, Flag, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.judging.records import FlagEvidence
from service.judging.store import Derivations
from service.models.records import Scope
from service.records.changes import withdraw_session
from service.records.flagging.acts import Occasion
from service.records.flagging.fold import settle_sessions
from service.sessions.decision import Verdict
from service.sessions.records import DiagnosisState
from service.sessions.store import Sessions
from service.sessions.tables import SessionRow
from service.storage import Storage
from service.units.store import Units
from service.uploads.receive import upload
from tests.conftest import Filled
from tests.databases import one_engine
from tests.service.made_records import step, way
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
STAND = "ODG-1"
GONE = "The diagnosis no longer finds it."
STICKS = FlagEvidence((Concern(Matter.CAUSE, "A3", 1, "A3 sticks."),), ())
AT_FAULT = FlagEvidence((Concern(Matter.STAND, STAND, 1, "The head is off centre."),), ())
SOUND = FlagEvidence((), ((Matter.STAND.value, STAND, GONE), (Matter.CAUSE.value, "*", GONE)))
MEASURED = tuple((unit, month) for unit in ("BA-1", "BA-2") for month in (1, 3, 5))


def measured(storage: Storage) -> None:
    """Three sessions each of two units, on one stand."""
    for unit, month in MEASURED:
        upload(storage, session_bytes(seed=month, month=month, unit=unit), "a.json", NOW)


@pytest.fixture
def known(filled: Filled) -> Storage:
    return filled(measured)


def session(storage: Storage, unit: str, month: int) -> str:
    with storage.database.reading() as store:
        return next(s.id for s in Sessions(store).of_unit(unit) if s.started_at.month == month)


def diagnosed(storage: Storage, unit: str, month: int, evidence: FlagEvidence) -> None:
    """Stores evidence as a diagnosis of the session would."""
    id = session(storage, unit, month)
    made = StoredDiagnosis(id, 0, DiagnosisState.NAMED, "", None, None, None, "1", NOW)
    with storage.database.writing() as store:
        Diagnoses(store).add_once(made)
        Derivations(store).keep_evidence(id, evidence)
        settle_sessions(store, Occasion(Units(store).hold(unit), id, NOW))


def flags(storage: Storage, matter: Matter = Matter.STAND) -> list[Flag]:
    """The newest first."""
    with storage.database.reading() as store:
        return sorted(Flags(store).page(FlagQuery(matter=matter)), key=lambda flag: -flag.id)


def opened(storage: Storage) -> list[tuple[Scope, str, str]]:
    return [(flag.scope, flag.subject, flag.summary) for flag in flags(storage) if flag.state is FlagState.RAISED]


def test_two_units_that_show_it_make_one_flag_that_names_both(known: Storage) -> None:
    diagnosed(known, "BA-1", 3, AT_FAULT)
    diagnosed(known, "BA-2", 3, AT_FAULT)
    assert opened(known) == [(Scope.STAND, STAND, "The head is off centre. Seen with BA-1, BA-2.")]
    with known.database.reading() as store:
        assert Flags(store).page(FlagQuery("BA-1")) == ()


def test_it_closes_with_its_reason_when_any_unit_no_longer_shows_it_and_comes_back_with_it(known: Storage) -> None:
    diagnosed(known, "BA-1", 1, AT_FAULT)
    diagnosed(known, "BA-2", 3, SOUND)
    [flag] = flags(known)
    assert (flag.state, flag.changes[-1].who, flag.changes[-1].text) == (FlagState.RESOLVED, "imu-health", GONE)
    diagnosed(known, "BA-1", 5, AT_FAULT)
    assert len(opened(known)) == 1


@one_engine
@pytest.mark.parametrize("order", list(permutations(range(3))))
def test_the_order_in_which_diagnoses_come_does_not_matter(known: Storage, order: tuple[int, ...]) -> None:
    every = (("BA-1", 1, AT_FAULT), ("BA-2", 3, SOUND), ("BA-1", 5, AT_FAULT))
    for number in order:
        diagnosed(known, *every[number])
    assert opened(known) == [(Scope.STAND, STAND, "The head is off centre. Seen with BA-1.")]


def test_a_session_that_is_withdrawn_takes_it_back(known: Storage) -> None:
    diagnosed(known, "BA-1", 5, AT_FAULT)
    withdraw_session(known, way(known), session(known, "BA-1", 5), step())
    assert opened(known) == []


def test_what_a_person_resolved_stays_so_until_a_later_session(known: Storage) -> None:
    diagnosed(known, "BA-1", 3, AT_FAULT)
    resolve_flag(known, flags(known)[0].id, "K. Ito", "head mended", NOW)
    diagnosed(known, "BA-2", 1, AT_FAULT)
    assert opened(known) == []
    diagnosed(known, "BA-2", 5, AT_FAULT)
    assert len(opened(known)) == 1


def test_what_a_diagnosis_no_longer_finds_closes_with_its_reason_and_is_a_new_flag_when_it_returns(
    known: Storage,
) -> None:
    diagnosed(known, "BA-1", 1, STICKS)
    diagnosed(known, "BA-1", 3, SOUND)
    [flag] = flags(known, Matter.CAUSE)
    assert [(change.kind.value, change.text) for change in flag.changes] == [
        ("flag.raised", "A3 sticks."), ("flag.resolved", GONE),
    ]  # fmt: skip
    diagnosed(known, "BA-1", 5, STICKS)
    assert [flag.state for flag in flags(known, Matter.CAUSE)] == [FlagState.RAISED, FlagState.RESOLVED]


def test_a_session_too_coarse_to_decide_closes_nothing(known: Storage) -> None:
    diagnosed(known, "BA-1", 1, STICKS)
    undecidable = update(SessionRow).where(SessionRow.id == session(known, "BA-1", 3))
    with known.database.engine.begin() as connection:
        connection.execute(undecidable.values(verdict=Verdict.UNDECIDABLE))
    diagnosed(known, "BA-1", 3, SOUND)
    assert [flag.state for flag in flags(known, Matter.CAUSE)] == [FlagState.RAISED]
    diagnosed(known, "BA-1", 5, SOUND)
    assert [flag.state for flag in flags(known, Matter.CAUSE)] == [FlagState.RESOLVED]
