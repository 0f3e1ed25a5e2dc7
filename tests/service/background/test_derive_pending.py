"""Many sessions that a change leaves to be judged again are judged beside the requests, and it can be read how many."""

from threading import Event

from service.background.derive_pending import derive_waiting
from service.flows.choose_reference import choose_reference
from service.flows.receive import upload
from service.storage import Storage
from tests.service.records import NOW, state_of, step, way
from tests.service.sessions import session_bytes

UNIT = "BA-017"


def filled(storage: Storage) -> list[str]:
    """Four sessions."""
    return [upload(storage, session_bytes(seed=m, month=m, a3_moved=20.0 * m), "a.json", NOW).id for m in (1, 2, 3, 4)]


def waiting(storage: Storage) -> int:
    with storage.database.reading() as store:
        return store.derivations.waiting_of(UNIT)


def test_what_is_judged_later_ends_as_what_is_judged_at_once(storage: Storage) -> None:
    ids = filled(storage)
    choose_reference(storage, way(storage, at_once=None), ids[3], step())
    at_once = state_of(storage, UNIT)
    choose_reference(storage, way(storage, at_once=None), ids[0], step())
    _, derived = choose_reference(storage, way(storage, at_once=2), ids[3], step())
    assert (derived.judged, derived.waiting, waiting(storage)) == ((ids[3],), 3, 3)
    derive_waiting(storage, 2.0, lambda: NOW, Event())
    assert waiting(storage) == 0
    assert state_of(storage, UNIT) == at_once


def test_who_is_the_reference_already_is_chosen_without_judging_the_others(storage: Storage) -> None:
    ids = filled(storage)
    _, derived = choose_reference(storage, way(storage), ids[0], step())
    assert derived.judged == (ids[0],)  # says from now on that it was chosen
