"""Fills an empty database with the demonstration fleet, through the same upload as a user's."""

from collections.abc import Callable
from datetime import timedelta

from estimator.session import ACCELEROMETER, GYROSCOPE
from service.demo.cast import CAST, START, Member
from service.demo.history import files_of
from service.demo.types import unit_type
from service.flag_records import NewService
from service.flows.diagnose import diagnose
from service.flows.fleet_condition import fleet_condition
from service.flows.record_service import record_service
from service.flows.upload import upload
from service.storage import Storage

UPLOADED_AFTER = timedelta(hours=3)
"""From the session to its upload; the demonstration has its own clock, so that it is always the same."""
WHO = "demonstration"
FILES = sum(member.files for member in CAST)


def is_wanted(storage: Storage) -> bool:
    """Whether the database is empty, or holds nothing but a demonstration whose filling was interrupted."""
    with storage.database.reading() as store:
        found = fleet_condition(store)
    return found.units == found.simulated < len(CAST)


def fill(storage: Storage, coverage_factor: float, advance: Callable[[], None]) -> None:
    """Uploads every session of every member, oldest unit first; ``advance`` is called once a session."""
    with storage.database.writing() as store:
        for kind in (ACCELEROMETER, GYROSCOPE):
            store.unit_types.add_once(unit_type(kind), START)
    for member in CAST:
        _upload_member(storage, member, coverage_factor, advance)


def _upload_member(storage: Storage, member: Member, coverage_factor: float, advance: Callable[[], None]) -> None:
    """One unit's life: sessions in order, each service recorded before the first session that follows it."""
    waiting = list(member.services)
    for file in files_of(member):
        while waiting and waiting[0].at <= file.at:
            done = waiting.pop(0)
            new = NewService(done.kind, done.at, done.note, done.who, done.sensor)
            record_service(storage, member.serial, new, done.at)
        at = file.at + UPLOADED_AFTER
        latest = upload(storage, file.content, file.name, at, coverage_factor=coverage_factor, simulated=True, who=WHO)
        advance()
    # The service diagnoses the earlier ones beside its first requests.
    diagnose(storage, latest.id, at)
