"""The life of a flag: raised once, seen again, found clear, acknowledged, resolved, and nothing of it lost."""

from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import select, text
from sqlalchemy.exc import DatabaseError

from service.errors import ConflictError, NotFoundError
from service.flags.changes import acknowledge_flag, resolve_flag
from service.flags.records import Flag, FlagState, Matter, NoticeKind
from service.flags.store import FlagQuery, Flags
from service.flags.tables import NoticeRow
from service.fleet.store import Fleet
from service.storage import Storage
from service.uploads.receive import upload
from tests.conftest import Filled
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)


def measured(storage: Storage, month: int, moved: float = 0.0, seed: int | None = None) -> str:
    """A session of BA-017 with A3's bias moved by so many µg."""
    content = session_bytes(seed=seed or month, month=month, a3_moved=moved)
    return upload(storage, content, f"{month}.json", NOW + timedelta(minutes=month)).id


def flags(storage: Storage) -> tuple[Flag, ...]:
    with storage.database.reading() as store:
        return Flags(store).page(FlagQuery("BA-017"))


def kinds(flag: Flag) -> list[str]:
    return [change.kind.value.removeprefix("flag.") for change in flag.changes]


def two_sessions(storage: Storage) -> None:
    """The second of them is out of tolerance."""
    measured(storage, 1)
    measured(storage, 2, 90.0)


@pytest.fixture
def flagged(filled: Filled) -> Storage:
    return filled(two_sessions)


def test_a_failing_session_raises_a_flag_on_the_sensor(flagged: Storage) -> None:
    [flag] = flags(flagged)
    assert (flag.matter, flag.place, flag.state) == (Matter.TOLERANCE, "A3", FlagState.RAISED)
    assert flag.summary.startswith("A3 bias changed by +9")
    assert kinds(flag) == ["raised"]


def test_the_same_matter_again_updates_the_open_flag(flagged: Storage) -> None:
    latest = measured(flagged, 3, 120.0)
    [flag] = flags(flagged)
    assert flag.session == latest
    assert flag.summary.startswith("A3 bias changed by +1")
    assert kinds(flag) == ["raised", "seen"]


def test_a_passing_session_proposes_to_resolve_once_and_resolves_nothing(flagged: Storage) -> None:
    measured(flagged, 3)
    measured(flagged, 4)
    [flag] = flags(flagged)
    assert flag.state is FlagState.RAISED
    assert flag.proposal == "The session of 1 Mar 2026 finds every parameter of A3 within its tolerance."
    assert kinds(flag) == ["raised", "clear"]


def test_a_matter_that_returns_takes_the_proposal_back(flagged: Storage) -> None:
    measured(flagged, 3)
    measured(flagged, 4, 90.0)
    [flag] = flags(flagged)
    assert flag.proposal == ""
    assert kinds(flag) == ["raised", "clear", "seen"]


def test_a_person_acknowledges_and_resolves_and_says_why(flagged: Storage) -> None:
    [raised] = flags(flagged)
    acknowledge_flag(flagged, raised.id, "K. Ito", "replacement ordered", NOW)
    done = resolve_flag(flagged, raised.id, "M. Okafor", "A3 replaced", NOW + timedelta(days=1))
    assert done.state is FlagState.RESOLVED
    assert [(c.kind, c.who, c.text) for c in done.changes[1:]] == [
        (NoticeKind.ACKNOWLEDGED, "K. Ito", "replacement ordered"),
        (NoticeKind.RESOLVED, "M. Okafor", "A3 replaced"),
    ]


def test_a_resolved_matter_that_returns_is_a_new_flag(flagged: Storage) -> None:
    resolve_flag(flagged, flags(flagged)[0].id, "K. Ito", "cable", NOW)
    measured(flagged, 3, 90.0)
    assert [flag.state for flag in flags(flagged)] == [FlagState.RAISED, FlagState.RESOLVED]


def test_an_acknowledged_matter_that_gets_worse_is_raised_again(storage: Storage) -> None:
    measured(storage, 1)
    measured(storage, 2, 53.0)
    [doubtful] = flags(storage)
    acknowledge_flag(storage, doubtful.id, "K. Ito", "watched", NOW)
    measured(storage, 3, 52.0)
    assert flags(storage)[0].state is FlagState.ACKNOWLEDGED
    measured(storage, 4, 200.0)
    assert flags(storage)[0].state is FlagState.RAISED
    assert kinds(flags(storage)[0]) == ["raised", "acknowledged", "seen", "raised"]


def test_what_does_not_fit_the_state_is_refused(flagged: Storage) -> None:
    id = flags(flagged)[0].id
    resolve_flag(flagged, id, "K. Ito", "done", NOW)
    for act in (acknowledge_flag, resolve_flag):
        with pytest.raises(ConflictError, match="is already resolved"):
            act(flagged, id, "K. Ito", "again", NOW)
        with pytest.raises(NotFoundError):
            act(flagged, id + 1, "K. Ito", "why", NOW)


def test_a_session_that_comes_in_late_says_what_it_would_have_said_in_time(flagged: Storage) -> None:
    measured(flagged, 4)
    measured(flagged, 3, 300.0)
    [flag] = flags(flagged)
    assert flag.summary.startswith("A3 bias changed by +30")
    assert flag.proposal == "The session of 1 Apr 2026 finds every parameter of A3 within its tolerance."
    assert kinds(flag) == ["raised", "clear", "seen", "clear"]


def test_what_a_person_resolved_no_older_session_raises_again(flagged: Storage) -> None:
    resolve_flag(flagged, flags(flagged)[0].id, "K. Ito", "cable", NOW)
    measured(flagged, 4)
    content = session_bytes(seed=9, a3_moved=300.0, started_at="2026-01-20T09:00:00Z")
    upload(flagged, content, "late.json", NOW)
    assert [f.state for f in flags(flagged) if f.matter is Matter.TOLERANCE] == [FlagState.RESOLVED]


def test_the_fleet_counts_open_flags(flagged: Storage) -> None:
    def counted() -> tuple[int, int]:
        with flagged.database.reading() as store:
            unit = Fleet(store).unit("BA-017")
            assert unit is not None
            return Fleet(store).condition().flags, unit.flags

    assert counted() == (1, 1)
    acknowledge_flag(flagged, flags(flagged)[0].id, "K. Ito", "seen", NOW)
    assert counted() == (1, 1)
    resolve_flag(flagged, flags(flagged)[0].id, "K. Ito", "done", NOW)
    assert counted() == (0, 0)


@pytest.mark.parametrize("statement", ["UPDATE notices SET who = 'x'", "DELETE FROM notices"])
def test_the_database_refuses_to_change_a_life(flagged: Storage, statement: str) -> None:
    with pytest.raises(DatabaseError, match="append-only"), flagged.database.engine.begin() as connection:
        connection.execute(text(statement))


def test_another_verdict_is_told(flagged: Storage) -> None:
    measured(flagged, 3)
    with flagged.database.engine.connect() as connection:
        query = select(NoticeRow.text).where(NoticeRow.kind == NoticeKind.VERDICT.value).order_by(NoticeRow.id.desc())
        told = connection.scalars(query).all()
    assert [line.split(";")[0] for line in told] == ["Unfit → Fit", "Reference set → Unfit"]
