"""A term that was learned becomes part of the model: sessions are computed again with it, and without it again."""

import pytest

from service.errors import RefusedError
from service.fleet.wanted_store import Announcements
from service.groups.records import Level
from service.models.records import ModelRevision, NewLasting, Scope
from service.records.models import accept_lasting, withdraw_model
from service.records.refresh_group import refresh_group
from service.sessions.calibrations_store import Calibrations
from service.storage import Storage
from service.uploads.receive import upload
from tests.databases import one_engine
from tests.service.grouped import WAVY, wavy_session
from tests.service.made_sessions import session_id
from tests.service.records.test_lasting import NOW, UNIT, brought, group, recompute_all

LEARNED = NewLasting("empirical-term", (), "K. Ito", "nobody knows what it is")


def refreshed(storage: Storage) -> None:
    """The unit's answer is made."""
    refresh_group(storage, group(storage), NOW)


def news(storage: Storage) -> list[str]:
    """Effects that the unit's sessions show together and no model holds."""
    with storage.database.reading() as store:
        return [one.own for one in Announcements(store).all(0, 10).found if one.group.level is Level.UNIT]


def taught(storage: Storage) -> ModelRevision:
    """The revision that holds what four sessions taught."""
    for content in WAVY:
        upload(storage, content, "a.json", NOW)
    refreshed(storage)
    return accept_lasting(storage, group(storage), LEARNED, NOW)


def zero_of_a2(storage: Storage, content: bytes) -> tuple[float, float]:
    """m/s²: the zero in force, and its standard uncertainty."""
    with storage.database.reading() as store:
        bias = Calibrations(store).get(session_id(content)).sensors[1].bias
    assert bias.value is not None
    assert bias.sigma is not None
    return bias.value, bias.sigma


@one_engine
def test_it_is_accepted_with_its_equation_and_the_sessions_are_computed_again(storage: Storage) -> None:
    revision = taught(storage)
    plain = zero_of_a2(storage, WAVY[0])
    recompute_all(storage)
    assert (revision.scope, revision.subject, revision.sensors) == (Scope.UNIT, UNIT, ("A2",))
    assert revision.evidence is not None
    assert revision.evidence.sentence.startswith("A2 reads high by (")
    assert "sin 3β" in revision.evidence.sentence
    assert brought(storage, revision.id)[0].outcome is not None
    assert zero_of_a2(storage, WAVY[0]) != plain


@one_engine
def test_a_later_session_is_calibrated_with_it(storage: Storage) -> None:
    taught(storage)
    later = wavy_session(6)
    upload(storage, later, "a.json", NOW)
    with storage.database.reading() as store:
        found = Calibrations(store).get(session_id(later))
    assert found.fit.p_value > 0.01


@one_engine
def test_it_goes_out_again_when_it_is_withdrawn(storage: Storage) -> None:
    revision = taught(storage)
    plain = zero_of_a2(storage, WAVY[0])
    recompute_all(storage)
    withdraw_model(storage, revision.id, "K. Ito", "the cable was it", NOW)
    recompute_all(storage)
    assert zero_of_a2(storage, WAVY[0]) == pytest.approx(plain)


@one_engine
def test_what_is_in_the_model_is_no_news_for_the_fleet(storage: Storage) -> None:
    for content in WAVY:
        upload(storage, content, "a.json", NOW)
    refreshed(storage)
    said = [news(storage)]
    accept_lasting(storage, group(storage), LEARNED, NOW)
    assert [*said, news(storage)] == [["Structure that no known cause explains."], []]


@one_engine
def test_none_is_accepted_where_none_was_learned(storage: Storage) -> None:
    upload(storage, wavy_session(0, 0.0), "a.json", NOW)
    refreshed(storage)
    with pytest.raises(RefusedError, match="accepted"):
        accept_lasting(storage, group(storage), LEARNED, NOW)
