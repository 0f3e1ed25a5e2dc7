"""`imu-health recalibrate`: stored sessions computed again under the models in force, in the database itself."""

from datetime import UTC, datetime
from typing import Annotated, Any

import typer

from service.commands.console import AsJson, print_json, progress, screen
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.flows.recalibrate import Recalibrated, recalibrate
from service.records.fleet import FleetQuery
from service.storage import Database, Files, Storage

PAGE = 1000
"""Serial numbers that one query brings."""
Units = Annotated[
    list[str] | None, typer.Argument(metavar="[UNIT]…", help="Serial numbers; all units if none is given.")
]


def recalibrate_units(
    units: Units = None, database_url: DatabaseUrl = None, data_folder: DataFolder = None, as_json: AsJson = False
) -> None:
    """Compute stored sessions again under the model in force; what was computed before stays readable."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    storage = Storage(Database(settings.database), Files(settings.files))
    storage.database.require_ready()
    wanted = units or _all_units(storage)
    with progress(len(wanted), "recalibrating", quiet=as_json) as advance:
        for serial in wanted:
            done = recalibrate(storage, serial, datetime.now(UTC), coverage_factor=settings.coverage_factor)
            print_json(_as_json(done)) if as_json else _print_line(done)
            advance()
    storage.database.close()


def _all_units(storage: Storage) -> list[str]:
    """Every serial number."""
    found: list[str] = []
    with storage.database.reading() as store:
        while len(page := store.fleet.units(FleetQuery(offset=len(found), limit=PAGE))) == PAGE:
            found += [unit.serial for unit in page]
    return found + [unit.serial for unit in page]


def _as_json(done: Recalibrated) -> dict[str, Any]:
    names = ("unit", "sessions", "recomputed", "unchanged", "left", "revision")
    moved = [{"session": one.session, "before": one.before, "after": one.after} for one in done.verdicts]
    return {name: getattr(done, name) for name in names} | {"verdicts": moved}


def _print_line(done: Recalibrated) -> None:
    left = f", {done.left} cannot be computed under it" if done.left else ""
    other = f", {len(done.verdicts)} with another verdict" if done.verdicts else ""
    line = f"{done.recomputed} recomputed, {done.unchanged} unchanged{left}{other}; model revision {done.revision}"
    screen().print(f"[bold]{done.unit}[/]  {line}", highlight=False)
