"""Fills an empty database with a large fleet of simulated units, to try the service with: sessions of three years,
custody, retirement, by the same upload as a user's.

Most units are stable; some drift, jump, were serviced, are overdue or too noisy to decide, are retired, or only
registered. It ends on the day on which it is made.
"""

import argparse
import os
import sys
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from multiprocessing import get_context
from pathlib import Path
from time import monotonic

import numpy as np

from estimator.session import ACCELEROMETER, GYROSCOPE
from service.app import utc_now
from service.demo.blocks import SENSORS, TYPE_NAME, ParameterMove, unit_type
from service.demo.cast import END, START, YEARS, DemoDrift, DemoMember, Intervention, Jump
from service.demo.fill import UPLOADED_AFTER
from service.demo.history import files_of
from service.fleet.changes import summarise_all
from service.kit.arriving_files import DEMONSTRATION
from service.kit.measures import YEAR
from service.opening import open_storage
from service.records.changes import record_service
from service.records.diagnose import diagnose
from service.records.register import Entering, enter, move_unit
from service.settings import Settings
from service.storage import Storage
from service.storage.folders import require_writable
from service.storage.schema import upgrade
from service.types.store import UnitTypes
from service.units.records import CustodyStep, Move, NewEntry, NewService
from service.units.store import Units
from service.uploads.receive import upload

LINES = 20
"""Lines that say how far it is."""
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


def main() -> int:
    """Fills the database, and says how far it is."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--units", type=int, default=300)
    asked.add_argument("--seed", type=int, default=1, help="the same number gives the same fleet")
    asked.add_argument("--data-folder", type=Path, default=None)
    given = asked.parse_args()
    settings = Settings() if given.data_folder is None else Settings(data_folder=given.data_folder)
    require_writable(settings.files)
    upgrade(settings.database)
    with opened(settings) as storage, storage.database.reading() as store:
        if Units(store).every():
            print("There are units already: fill an empty database, --data-folder names one.", file=sys.stderr)
            return 1
    planned, start, done = plan(given.units, given.seed), monotonic(), 0
    print(f"{given.units} simulated units, {planned.files} sessions.")
    for sessions in fill_many(settings, planned, utc_now(), os.cpu_count() or 1):
        before, done = done, done + sessions
        if done * LINES // planned.files > before * LINES // planned.files:
            left = (monotonic() - start) * (planned.files - done) / done
            print(f"{done:,} of {planned.files:,} sessions, {left // 60:.0f} min {left % 60:.0f} s left", flush=True)
    print(f"Done in {monotonic() - start:.0f} s. The service diagnoses earlier sessions beside its first requests.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
