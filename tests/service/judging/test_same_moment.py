"""Two files of one block and one moment count once: the later one is asked which of them it is."""

import json

import pytest

from service.records.supersede import successor_of, supersede_session
from service.sessions.records import Receipt
from service.sessions.sent import Replaced, Stated
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import all_on_one_engine as pytest_generate_tests  # noqa: F401 - pytest calls it
from tests.databases import one_engine
from tests.service.made_records import NOW, state_of, way
from tests.service.made_sessions import session_bytes

UNIT = "BA-017"
FIRST, WRONG, RIGHT = session_bytes(), session_bytes(seed=2, month=5, a3_moved=300.0), session_bytes(seed=2, month=5)
ASKED = "The session of wrong.json was measured at the same moment, 1 May 2026, 09:00:00 UTC"


def sent(storage: Storage, content: bytes, filename: str = "a.json") -> Receipt:
    return upload(storage, content, filename, NOW)


@pytest.fixture
def asked(storage: Storage) -> tuple[str, str]:
    """A session, and one of its moment that waits."""
    sent(storage, FIRST)
    return sent(storage, WRONG, "wrong.json").id, sent(storage, RIGHT).id


def test_a_second_file_of_a_moment_is_questioned_and_counts_nothing(storage: Storage) -> None:
    sent(storage, FIRST)
    sent(storage, WRONG, "wrong.json")
    before = state_of(storage, UNIT)
    receipt = sent(storage, RIGHT)
    assert (receipt.state, ASKED in receipt.reason) == (RecordState.QUESTIONED, True)
    assert state_of(storage, UNIT) == before


@one_engine
def test_one_that_stands_for_the_other_counts_as_if_it_had_said_so(storage: Storage, asked: tuple[str, str]) -> None:
    wrong, right = asked
    assert successor_of(storage, wrong) == right
    supersede_session(storage, way(storage), Replaced(wrong, "K. Ito", "read off wrongly"), right)
    with storage.database.reading() as store:
        assert Sessions(store).get(right).state is RecordState.ACCEPTED
        assert Sessions(store).get(wrong).superseded_by == right
        assert [s.id for s in Sessions(store).of_unit(UNIT) if s.state is RecordState.ACCEPTED][1:] == [right]


@one_engine
def test_the_file_sent_again_with_the_name_of_the_other_counts_too(storage: Storage, asked: tuple[str, str]) -> None:
    replaces = Replaced(asked[0], "K. Ito", "read off wrongly")
    receipt = upload(storage, RIGHT, "a.json", NOW, stated=Stated(replaces=replaces))
    assert (receipt.created, receipt.state) == (False, RecordState.ACCEPTED)


@one_engine
def test_what_is_doubted_for_more_stays_questioned(storage: Storage) -> None:
    sent(storage, FIRST)
    wrong = sent(storage, WRONG, "wrong.json").id
    document = json.loads(RIGHT)
    for sensor in document["sensors"]:
        sensor["nominal_scale"] *= 1000
    right = sent(storage, json.dumps(document).encode()).id
    supersede_session(storage, way(storage), Replaced(wrong, "K. Ito", "read off wrongly"), right)
    with storage.database.reading() as store:
        assert Sessions(store).get(right).state is RecordState.QUESTIONED


@one_engine
@pytest.mark.parametrize("changes", [{"stage": "as-left"}, {"unit": "BA-018"}, {"started_at": "2026-05-01T09:00:01Z"}])
def test_two_measurements_are_two(storage: Storage, changes: dict[str, str]) -> None:
    sent(storage, FIRST)
    sent(storage, session_bytes(seed=2, month=5, stage="as-found"))
    assert sent(storage, session_bytes(seed=3, month=5, **changes)).state is RecordState.ACCEPTED


@one_engine
def test_files_that_say_no_moment_share_none(storage: Storage) -> None:
    for seed in (1, 2):
        document = json.loads(session_bytes(seed=seed))
        del document["started_at"]
        assert sent(storage, json.dumps(document).encode()).state is RecordState.ACCEPTED
