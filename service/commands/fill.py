"""`imu-health fill`: a large fleet of simulated units in an empty database, to try the service with."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Annotated

import typer

from service.app import utc_now
from service.commands.console import progress
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.commands.speech import many, say
from service.demo.many import fill_many, plan
from service.errors import ConflictError
from service.opening import open_database
from service.storage import Files, Storage
from service.storage.folders import require_writable
from service.storage.schema import upgrade
from service.units.store import Units

LINES = 10
"""Lines that say how far it is."""


def fill(
    units: Annotated[int, typer.Option(min=1, max=20_000, help="How many.")] = 300,
    seed: Annotated[int, typer.Option(min=0, help="The same number gives the same fleet.")] = 1,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Fill an empty database with a large fleet of simulated units: sessions of three years, custody, retirement."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    require_writable(settings.files)
    upgrade(settings.database)
    storage = Storage(open_database(settings.database), Files(settings.files))
    try:
        with storage.database.reading() as store:
            if Units(store).every():
                raise ConflictError("There are units already: fill an empty database, --data-folder names one.")
        planned = plan(units, seed)
        say(f"{many(units, 'simulated unit')}, {many(planned.files, 'session')}.")
        with progress(planned.files, "simulating, calibrating, storing") as advance, _told(planned.files) as tell:
            fill_many(storage, planned, settings.coverage_factor, utc_now(), lambda: (advance(), tell()))
    finally:
        storage.database.close()


@contextmanager
def _told(total: int) -> Iterator[Callable[[], None]]:
    """Says now and then how far it is and how long the rest will take."""
    start, done = monotonic(), 0

    def tell() -> None:
        nonlocal done
        done += 1
        if done * LINES // total > (done - 1) * LINES // total:
            left = (monotonic() - start) * (total - done) / done
            say(f"{done:,} of {total:,} sessions; {left / 60:.0f} min {left % 60:.0f} s left")

    yield tell
    say(f"Done in {monotonic() - start:.0f} s. The service diagnoses earlier sessions beside its first requests.")
