"""Fills an empty database with the demonstration fleet, simulated units with a history of some years, by the same
upload as a user's."""

from collections.abc import Callable
from datetime import timedelta

from estimator.session import ACCELEROMETER, GYROSCOPE
from service.demo.blocks import unit_type
from service.demo.cast import CAST, START, DemoHandling, DemoMember, Intervention, Remark
from service.demo.history import files_of
from service.flags.changes import bring_flags
from service.flags.store import FlagQuery, Flags
from service.fleet.store import Fleet
from service.kit.arriving_files import DEMONSTRATION
from service.records.changes import record_service
from service.records.diagnose import diagnose
from service.records.unit_changes import add_note
from service.sessions.store import Sessions
from service.storage import Storage
from service.types.store import UnitTypes
from service.units.records import NewService
from service.units.remarks_store import Notes
from service.uploads.receive import upload

UPLOADED_AFTER = timedelta(hours=3)
"""Time from the session to its upload; the demonstration has its own clock, so that it is always the same."""
Done = Intervention | DemoHandling | Remark
"""Acts of people between sessions."""
FILES = sum(member.files for member in CAST)
"""Sessions of the whole fleet."""


def is_wanted(storage: Storage) -> bool:
    """Whether the database is empty, or holds nothing but a demonstration whose filling was interrupted."""
    with storage.database.reading() as store:
        units = Fleet(store).condition().units
        return units == 0 or (units < len(CAST) and Sessions(store).only_demonstration())


def fill(storage: Storage, coverage_factor: float, advance: Callable[[], None]) -> None:
    """Uploads every session of every member; ``advance`` is called once a session. Existing sessions stay."""
    with storage.database.writing() as store:
        for kind in (ACCELEROMETER, GYROSCOPE):
            UnitTypes(store).add_once(unit_type(kind), START)
    for member in CAST:
        _upload_member(storage, member, coverage_factor, advance)


def _upload_member(storage: Storage, member: DemoMember, coverage_factor: float, advance: Callable[[], None]) -> None:
    """Uploads one unit's life: sessions in order, and people's acts in between."""
    waiting: list[Done] = [*member.services, *member.handled, *member.remarks]
    waiting.sort(key=lambda done: done.at)
    files = list(files_of(member))
    for file in files:
        while waiting and waiting[0].at <= file.at:
            _do(storage, member.serial, waiting.pop(0))
        at = file.at + UPLOADED_AFTER
        latest = upload(
            storage, file.content, file.name, at,
            coverage_factor=coverage_factor, who=DEMONSTRATION,
            outlook=file is files[-1], is_dated_later=False,
        )  # fmt: skip
        advance()
    # The service diagnoses the earlier ones beside its first requests.
    diagnose(storage, latest.id, at)
    for done in waiting:
        _do(storage, member.serial, done)


def _do(storage: Storage, serial: str, done: Done) -> None:
    match done:
        case Intervention():
            new = NewService(done.kind, done.at, done.note, done.who, done.sensor)
            record_service(storage, serial, new, done.at)
        case DemoHandling():
            _handle(storage, serial, done)
        case Remark():
            _remark(storage, serial, done)


def _remark(storage: Storage, serial: str, done: Remark) -> None:
    """Notes it, unless a filling that was interrupted did."""
    with storage.database.reading() as store:
        noted = {(note.at, note.text) for note in Notes(store).of_unit(serial)}
    if (done.at, done.text) not in noted:
        add_note(storage, serial, done.text, at=done.at, who=done.who, now=done.at)


def _handle(storage: Storage, serial: str, done: DemoHandling) -> None:
    """Handles the latest flag on the matter of the sensor, unless a filling that was interrupted did."""
    with storage.database.reading() as store:
        flags = Flags(store).page(FlagQuery(unit=serial, matter=done.matter))
    latest = max(flag.id for flag in flags if flag.place == done.sensor and flag.raised_at <= done.at)
    bring_flags(storage, (latest,), done.state, done.who, done.why, done.at)
