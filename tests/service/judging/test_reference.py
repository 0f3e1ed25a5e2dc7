"""The reference of an epoch: the first comparable session by time measured, from one service up to the next."""

from datetime import UTC, datetime

from estimator.session import ACCELEROMETER, IN_SERVICE, ROTATION_ALIGNMENT, TWO_AXIS_STAND
from service.judging.reference import EpochReference, reference_of
from service.records.changes import record_service
from service.storage import Storage
from service.units.records import NewService
from service.units.store import Units
from service.uploads.receive import upload
from tests.service.made_sessions import session_bytes

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
APRIL, JUNE, AUGUST = (datetime(2026, month, 1, 9, tzinfo=UTC) for month in (4, 6, 8))
"""Times of measurement in these months, to the second."""


def stored(storage: Storage, month: int) -> str:
    """The id of a calibration measured in a month."""
    return upload(storage, session_bytes(month=month, seed=month), "a.json", NOW).id


def serviced(storage: Storage, at: datetime) -> None:
    """A repair of the unit."""
    record_service(storage, "BA-017", NewService("repair", at), NOW)


def chosen(storage: Storage, at: datetime, programme: str = TWO_AXIS_STAND) -> EpochReference:
    """The reference for a session measured at a time."""
    with storage.database.reading() as store:
        return reference_of(store, Units(store).key("BA-017"), ACCELEROMETER, programme, at)


def test_the_session_that_was_measured_first_is_the_reference_whenever_it_came_in(storage: Storage) -> None:
    stored(storage, 5)
    first = stored(storage, 3)
    assert chosen(storage, APRIL) == chosen(storage, AUGUST) == EpochReference(first, None)


def test_after_a_service_there_is_none_until_the_next_session(storage: Storage) -> None:
    stored(storage, 3)
    serviced(storage, JUNE)
    assert chosen(storage, AUGUST) == EpochReference(None, JUNE)


def test_a_session_at_the_moment_of_the_service_is_the_reference_after_it(storage: Storage) -> None:
    stored(storage, 3)
    serviced(storage, JUNE)
    second = stored(storage, 6)
    assert chosen(storage, JUNE) == chosen(storage, AUGUST) == EpochReference(second, JUNE)


def test_a_session_at_the_moment_of_the_service_is_none_before_it(storage: Storage) -> None:
    stored(storage, 9)
    serviced(storage, AUGUST)
    serviced(storage, JUNE)
    second = stored(storage, 6)
    assert chosen(storage, JUNE).session == second
    assert chosen(storage, APRIL) == EpochReference(None, None)


def test_a_recording_in_service_is_compared_with_the_calibrations_reference(storage: Storage) -> None:
    calibration = stored(storage, 3)
    assert chosen(storage, APRIL, IN_SERVICE).session == calibration


def test_an_alignment_is_not_judged_against_a_calibration(storage: Storage) -> None:
    stored(storage, 3)
    assert chosen(storage, APRIL, ROTATION_ALIGNMENT).session is None
