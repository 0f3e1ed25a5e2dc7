"""Fills an empty database with the demonstration fleet, or a large one to try the service with: simulated units with a
history of some years, as many as one likes. Files go through the same upload as a user's.

Of the large fleet most units are stable; some drift, jump, were serviced, are overdue or too noisy to decide, are
retired, or only registered. It ends on the day on which it is made.
"""

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from multiprocessing import get_context

import numpy as np

from estimator.session import ACCELEROMETER, GYROSCOPE
from service.demo.blocks import SENSORS, TYPE_NAME, ParameterMove, unit_type
from service.demo.cast import CAST, END, START, YEARS, DemoDrift, DemoHandling, DemoMember, Intervention, Jump, Remark
from service.demo.history import files_of
from service.flags.changes import bring_flags
from service.flags.store import FlagQuery, Flags
from service.fleet.changes import summarise_all
from service.fleet.store import Fleet
from service.kit.arriving_files import DEMONSTRATION
from service.kit.measures import YEAR
from service.opening import open_storage
from service.records.changes import record_service
from service.records.diagnose import diagnose
from service.records.register import Entering, enter, move_unit
from service.records.unit_changes import add_note
from service.sessions.store import Sessions
from service.settings import Settings
from service.storage import Storage
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry, NewService
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


LIMIT = {ACCELEROMETER: {"scale": 100.0, "bias": 50.0, "axis": 20.0}, GYROSCOPE: {"scale": 3000.0, "bias": 0.03}}
"""Tolerances of what may change: ppm; µg or °/h; arcsec."""
SHARES = {"stable": 0.70, "drift": 0.14, "jump": 0.05, "serviced": 0.04, "noisy": 0.01, "overdue": 0.04, "new": 0.02}
"""Shares of the fleet by the course of a unit's life."""
REGISTERED, RETIRED = 0.02, 0.02
"""Shares of the fleet that were never measured, and that are retired."""
SESSIONS = (3, 6)
"""Fewest and most sessions of a unit."""
GYROS = 0.2
"""Share of the units that are gyros."""
LOCATIONS = ("Hangar 1", "Hangar 2", "Line station north", "Line station south", "Laboratory", "Store")
CUSTODIANS = ("A. Lindqvist", "K. Ito", "M. Okafor", "R. Duarte", "M. Sato", "")
OWNERS = ("Northern Airways", "Survey Ltd", "")


@dataclass(frozen=True)
class Life:
    """A unit before it is made, and the seed of its chances."""

    member: DemoMember
    seed: tuple[int, int]


@dataclass(frozen=True)
class ManyPlan:
    """A fleet before it is made."""

    lives: tuple[Life, ...]
    entries: tuple[NewEntry, ...]
    retired: tuple[str, ...]

    @property
    def files(self) -> int:
        """Sessions of all units."""
        return sum(life.member.files for life in self.lives)


def plan(units: int, seed: int) -> ManyPlan:
    """The plan of a fleet of so many units; the same for the same seed."""
    rng = np.random.default_rng(seed)
    kinds = [GYROSCOPE if rng.random() < GYROS else ACCELEROMETER for _ in range(units)]
    serials = [f"{'FG' if kind == GYROSCOPE else 'FA'}-{number:05d}" for number, kind in enumerate(kinds, 1)]
    unmeasured = round(REGISTERED * units)
    pairs = zip(serials[unmeasured:], kinds[unmeasured:], strict=True)
    lives = tuple(Life(_member(serial, kind, rng), (seed, number)) for number, (serial, kind) in enumerate(pairs))
    entries = tuple(
        NewEntry(serial, TYPE_NAME[kind], *(str(rng.choice(texts)) for texts in (OWNERS, LOCATIONS, CUSTODIANS)))
        for serial, kind in zip(serials, kinds, strict=True)
    )
    return ManyPlan(lives, entries, tuple(serials[-max(1, round(RETIRED * units)) :]))


def _member(serial: str, kind: str, rng: np.random.Generator) -> DemoMember:
    story = str(rng.choice(list(SHARES), p=list(SHARES.values())))
    joined = float(rng.uniform(0.0, 1.5))
    plain = DemoMember(serial, kind, story, int(rng.integers(*SESSIONS, endpoint=True)), joined)
    parameter = str(rng.choice(list(LIMIT[kind])))
    share = float(rng.choice((-1, 1)) * rng.uniform(0.3, 1.3))
    change = ParameterMove(int(rng.integers(SENSORS)), parameter, share * LIMIT[kind][parameter])
    match story:
        case "drift":
            return replace(plain, drifts=(DemoDrift(change, power=float(rng.uniform(1.0, 2.0))),))
        case "jump":
            return replace(plain, jumps=(Jump(change, float(rng.uniform(joined + 0.3, YEARS - 0.3))),))
        case "serviced":
            at = START + float(rng.uniform(joined + 0.4, YEARS - 0.5)) * YEAR
            done = Intervention(at, "adjustment", "Adjusted to nominal.", (change,), "R. Duarte")
            return replace(plain, services=(done,))
        case "noisy":
            return replace(plain, noise={-1: 60.0})
        case "overdue":
            return replace(plain, left=joined + 0.3)
        case "new":
            return replace(plain, joined=YEARS - 0.4, sessions=2)
    return plain


@contextmanager
def opened(settings: Settings) -> Iterator[Storage]:
    """The stores of the settings, closed at the end."""
    storage = open_storage(settings)
    try:
        yield storage
    finally:
        storage.database.close()


def fill_many(settings: Settings, planned: ManyPlan, now: datetime, workers: int) -> Iterator[int]:
    """Makes the fleet in an empty database, by so many processes; reports the number of sessions of each unit."""
    with opened(settings) as storage:
        with storage.database.writing() as store:
            for kind in (ACCELEROMETER, GYROSCOPE):
                UnitTypes(store).add_once(unit_type(kind), now - (END - START))
        enter(storage, planned.entries, Entering(DEMONSTRATION, now))
        if workers == 1:
            yield from (_fill_one(storage, settings, life, now) for life in planned.lives)
        else:
            with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
                made = [pool.submit(_fill_beside, settings, life, now) for life in planned.lives]
                yield from (future.result() for future in as_completed(made))
        for serial in planned.retired:
            retire = Move(remark="Beyond repair.", step=CustodyStep.RETIRED)
            move_unit(storage, serial, retire, DEMONSTRATION, now)
        summarise_all(storage, now)


def _fill_beside(settings: Settings, life: Life, now: datetime) -> int:
    with opened(settings) as storage:
        return _fill_one(storage, settings, life, now)


def _fill_one(storage: Storage, settings: Settings, life: Life, now: datetime) -> int:
    """One unit's life: its sessions in order, a service between them, and the diagnosis of the latest."""
    member, shift = life.member, timedelta(days=(now - END).days - 1)
    files, waiting = list(files_of(member, np.random.default_rng(life.seed), shift)), list(member.services)
    for file in files:
        while waiting and waiting[0].at + shift <= file.at:
            done = waiting.pop(0)
            new = NewService(done.kind, done.at + shift, done.note, done.who)
            record_service(storage, member.serial, new, done.at + shift)
        at = file.at + UPLOADED_AFTER
        latest = upload(
            storage, file.content, file.name, at, coverage_factor=settings.coverage_factor, who=DEMONSTRATION,
            outlook=file is files[-1], is_dated_later=False,
        )  # fmt: skip
    diagnose(storage, latest.id, at)
    return len(files)
