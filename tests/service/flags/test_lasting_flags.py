"""An effect that sessions show together is flagged once, until it is accepted into the model or somebody settles it."""

from dataclasses import replace
from datetime import UTC, datetime

import pytest

from service.flags.changes import resolve_flag
from service.flags.pages import flag_cards
from service.flags.records import Concern, Flag, FlagState, Matter
from service.flags.store import FlagQuery, Flags
from service.fleet.store import Fleet
from service.fleet.wanted_store import Announcements
from service.groups.records import Group, Level
from service.groups.sections import found_line
from service.groups.store import Groups, read_group
from service.models.records import NewLasting, Scope
from service.records.changes import withdraw_session
from service.records.flagging.acts import COVERED, Occasion, raise_flag
from service.records.flagging.lasting import flag_lasting
from service.records.models import accept_lasting, withdraw_model
from service.records.refresh_group import current, members_of, refresh_group
from service.settings import Settings
from service.storage import Storage
from service.storage.queries import Store
from service.storage.schema import downgrade, upgrade
from service.units.store import Units
from service.uploads.receive import upload
from tests.conftest import SettingsFilled
from tests.databases import one_engine
from tests.service.grouped import CUBIC, cubic_session
from tests.service.made_records import step, way
from tests.service.made_sessions import session_id
from tests.stock import stores

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
GROUP = tuple(cubic_session(number, cubic=4 * CUBIC) for number in range(5))
NEW = NewLasting("cubic-nonlinearity", (), "K. Ito", "")


def group(storage: Storage) -> Group:
    with storage.database.reading() as store:
        return Groups(store).find(Level.UNIT, "BA-017")


def flags(storage: Storage) -> list[Flag]:
    with storage.database.reading() as store:
        return list(Flags(store).page(FlagQuery(matter=Matter.LASTING)))


def refreshed(storage: Storage) -> list[Flag]:
    refresh_group(storage, group(storage), NOW)
    return flags(storage)


def shown(settings: Settings) -> None:
    """A unit whose four sessions show a cubic term, and its flag."""
    with stores(settings) as storage:
        for content in GROUP[:4]:
            upload(storage, content, "a.json", NOW)
        refresh_group(storage, group(storage), NOW)


@pytest.fixture
def settings(settings_filled: SettingsFilled) -> Settings:
    return settings_filled(shown)


@pytest.fixture
def flagged(storage: Storage) -> Storage:
    """The stores of that unit."""
    return storage


def test_an_effect_is_flagged_once(flagged: Storage) -> None:
    upload(flagged, GROUP[4], "a.json", NOW)
    (flag,) = refreshed(flagged)
    assert (flag.unit, flag.place) == ("BA-017", "unit BA-017: cubic nonlinearity (A2)")
    assert flag.summary.startswith("The sessions of unit BA-017 show together: A2 has a cubic")
    assert flag.session == session_id(GROUP[3])


def test_an_effect_of_a_unit_with_the_longest_name_is_flagged_once_and_found_again(storage: Storage) -> None:
    serial = 200 * "B"
    for number in range(4):
        upload(storage, cubic_session(number, unit=serial, cubic=4 * CUBIC), "a.json", NOW)
    with storage.database.reading() as store:
        longest = Groups(store).find(Level.UNIT, serial)
    for _ in range(2):
        refresh_group(storage, longest, NOW)
        (flag,) = (found for found in flags(storage) if found.unit == serial)
        assert flag.place.endswith(": cubic nonlinearity (A2)")
        assert len(flag.place) <= 200


@one_engine
def test_what_is_accepted_is_known_and_comes_back_when_it_is_withdrawn(flagged: Storage) -> None:
    revision = accept_lasting(flagged, group(flagged), NEW, NOW)
    (flag,) = refreshed(flagged)
    assert (flag.state, flag.changes[-1].text) == (
        FlagState.RESOLVED, "Accepted into the model of unit BA-017, revision 1.",
    )  # fmt: skip
    withdraw_model(flagged, revision.id, "K. Ito", "seen in error", NOW)
    assert [f.state for f in refreshed(flagged)] == [FlagState.RAISED, FlagState.RESOLVED]


@one_engine
def test_what_a_person_settled_stays_settled(flagged: Storage) -> None:
    resolve_flag(flagged, flags(flagged)[0].id, "K. Ito", "by design", NOW)
    upload(flagged, GROUP[4], "a.json", NOW)
    assert [f.state for f in refreshed(flagged)] == [FlagState.RESOLVED]


@one_engine
def test_what_the_sessions_no_longer_show_is_closed_with_the_reason(flagged: Storage) -> None:
    for content in GROUP[:3]:
        withdraw_session(flagged, way(flagged), session_id(content), step())
    (flag,) = refreshed(flagged)
    assert (flag.state, flag.changes[-1].text) == (FlagState.RESOLVED, "The sessions together no longer show it.")


@one_engine
def test_an_effect_that_a_flag_of_the_sensor_tells_of_has_none(flagged: Storage) -> None:
    with flagged.database.writing() as store:
        concern = Concern(Matter.CAUSE, "A2", 1, "A2 bends.")
        raise_flag(store, Occasion(Units(store).key("BA-017"), None, NOW), concern)
    (flag,) = refreshed(flagged)
    assert (flag.state, flag.changes[-1].text) == (FlagState.RESOLVED, COVERED)
    with flagged.database.reading() as store:
        (own,) = Flags(store).page(FlagQuery(matter=Matter.CAUSE))
    resolve_flag(flagged, own.id, "K. Ito", "by design", NOW)
    assert [f.state for f in refreshed(flagged)] == [FlagState.RAISED, FlagState.RESOLVED]


@one_engine
def test_the_fleet_says_what_was_found_while_it_is_of_the_sessions_of_now(flagged: Storage) -> None:
    with flagged.database.reading() as store:
        line = found_line(Announcements(store).all(9, 4))
    assert line is not None
    ((home, whose, what),) = line.found
    assert (home, whose, line.more) == ("/units/BA-017#together", "unit BA-017", 0)
    assert what.startswith("A2 has a cubic nonlinearity")
    upload(flagged, GROUP[4], "a.json", NOW)
    with flagged.database.reading() as store:
        assert found_line(Announcements(store).all(9, 4)) is None


def counted(store: Store) -> tuple[int, int]:
    """Open flags of the fleet, and of the unit."""
    unit = Fleet(store).unit("BA-017")
    assert unit is not None
    return Fleet(store).condition().flags, unit.flags


def of_stand(storage: Storage) -> None:
    """Attributes the unit's effect to the stand."""
    with storage.database.writing() as store:
        answer = current(store, group(storage))
        assert answer is not None
        (shown,) = read_group(answer.document or {}).findings
        members = members_of(store, group(storage))
        stand = Groups(store).find(Level.STAND, "ODG-1")
        flag_lasting(store, stand, [replace(shown, level="stand", subject="ODG-1")], members.sessions[-1], NOW)


def test_a_stand_s_effect_is_a_flag_of_the_stand_and_of_no_unit(flagged: Storage) -> None:
    of_stand(flagged)
    with flagged.database.reading() as store:
        (about,) = Flags(store).page(FlagQuery(stand="ODG-1"))
        own = Flags(store).page(FlagQuery("BA-017"))
        counts = counted(store)
    assert (about.scope, about.subject, about.unit) == (Scope.STAND, "ODG-1", "BA-017")
    assert [flag.scope for flag in own] == [Scope.UNIT]
    assert counts == (2, 1)


@one_engine
def test_it_leads_to_the_stand_s_page_and_is_found_by_its_name(flagged: Storage) -> None:
    of_stand(flagged)
    with flagged.database.reading() as store:
        found = Flags(store).page(FlagQuery(text="odg"))
    (card,) = flag_cards(found)
    assert (card.home, card.name) == ("/stands/ODG-1", "ODG-1")


def test_it_was_the_unit_s_before_flags_said_whose_they_are(flagged: Storage, store_url: str) -> None:
    of_stand(flagged)
    with flagged.database.reading() as store:
        before = Flags(store).page(FlagQuery())
    flagged.database.close()
    downgrade(store_url, "0023")
    upgrade(store_url)
    with flagged.database.reading() as store:
        assert Flags(store).page(FlagQuery()) == before
        assert counted(store) == (2, 1)
