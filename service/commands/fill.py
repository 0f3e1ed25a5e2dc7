"""`imu-health fill`: a large fleet of simulated units in an empty database, to try the service with."""

import os
from time import monotonic
from typing import Annotated

import typer

from service.app import utc_now
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.commands.speech import many, say
from service.demo.fill import fill_many, opened, plan
from service.errors import ConflictError
from service.storage.folders import require_writable
from service.storage.schema import upgrade
from service.units.store import Units

LINES = 20
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
    with opened(settings) as storage, storage.database.reading() as store:
        if Units(store).every():
            raise ConflictError("There are units already: fill an empty database, --data-folder names one.")
    planned, start, done = plan(units, seed), monotonic(), 0
    say(f"{many(units, 'simulated unit')}, {many(planned.files, 'session')}.")
    for sessions in fill_many(settings, planned, utc_now(), os.cpu_count() or 1):
        before, done = done, done + sessions
        if done * LINES // planned.files > before * LINES // planned.files:
            left = (monotonic() - start) * (planned.files - done) / done
            say(f"{done:,} of {planned.files:,} sessions, {left // 60:.0f} min {left % 60:.0f} s left")
    say(f"Done in {monotonic() - start:.0f} s. The service diagnoses earlier sessions beside its first requests.")
