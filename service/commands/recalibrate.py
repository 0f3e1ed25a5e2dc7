"""`imu-health recalibrate`: stored sessions computed again under the models in force, in the database itself."""

import os
from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Annotated

import typer

from estimator.json_object import Json
from service.commands.console import AsJson, print_json, progress, screen
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.commands.speech import FAILED, many, say
from service.models.store import Models
from service.opening import open_storage
from service.records.many import Outcome, Run, by_workers, can_share, one_by_one, units_behind
from service.records.recalibrate import Recalibrated
from service.settings import Settings
from service.storage import Storage

WORTH_STARTING = 100
"""Units for which other processes are started unless somebody says how many: their start takes some five seconds."""
Units = Annotated[list[str] | None, typer.Argument(metavar="[UNIT]…", help="Serial numbers.", show_default=False)]
All = Annotated[bool, typer.Option("--all", help="Every unit with sessions that another model concerns since.")]
Workers = Annotated[
    int | None, typer.Option(min=1, help="Processes.", show_default="one, and for a hundred units as many as cores")
]
Scheduler = Annotated[
    str | None,
    typer.Option(help="Address of a Dask scheduler whose workers compute: tcp://host:8786, tls://host:8786."),
]


@dataclass(frozen=True)
class How:
    """In which processes."""

    workers: int | None
    scheduler: str | None
    quiet: bool
    """Without a bar."""


def recalibrate_units(
    units: Units = None,
    *,
    all_units: All = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    as_json: AsJson = False,
) -> None:
    """Compute stored sessions again under the model in force; what was computed before stays readable."""
    if units and all_units:
        raise typer.BadParameter("give serial numbers of units, or --all, which is what none means")
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    storage = open_storage(settings)
    storage.database.require_ready()
    sums = _Sums()
    for outcome in _outcomes(storage, settings, units, How(workers, scheduler, as_json)):
        sums.add(outcome)
        _show(outcome, as_json)
    storage.database.close()
    if not as_json:
        screen().print(sums.in_words(), highlight=False)
    if sums.failed:
        raise typer.Exit(FAILED)


def _outcomes(storage: Storage, settings: Settings, units: list[str] | None, how: How) -> Iterator[Outcome]:
    """Unit after unit as it is done."""
    with storage.database.reading() as store:
        count = len(units) if units else Models(store).count_behind()
    wanted: Iterable[str] = units or units_behind(storage)
    with progress(count, "recalibrating", quiet=how.quiet) as advance, _run(storage, settings, count, how) as run:
        for outcome in run(wanted):
            yield outcome
            advance()


def _run(storage: Storage, settings: Settings, count: int, how: How) -> AbstractContextManager[Run]:
    def clock() -> datetime:
        return datetime.now(UTC)

    is_worth_it = count >= WORTH_STARTING and can_share()
    workers = how.workers or ((os.cpu_count() or 1) if is_worth_it else 1)
    if how.scheduler is None and workers == 1:
        return nullcontext(one_by_one(storage, clock, settings.coverage_factor))
    return by_workers(storage, settings, clock, workers=workers, scheduler=how.scheduler)


class _Sums:
    """What became of all units."""

    def __init__(self) -> None:
        self.units = self.failed = self.recomputed = self.left = self.moved = 0

    def add(self, one: Outcome) -> None:
        self.units += 1
        if one.done is None:
            self.failed += 1
        else:
            self.recomputed += one.done.recomputed
            self.left += one.done.left
            self.moved += len(one.done.verdicts)

    def in_words(self) -> str:
        """``2 units: 12 sessions recomputed, 1 with another verdict, 0 left, 0 units failed``."""
        if not self.units:
            return "Nothing to do: every session is computed under the model that concerns it."
        told = f"{many(self.recomputed, 'session')} recomputed, {self.moved:,} with another verdict"
        return f"{many(self.units, 'unit')}: {told}, {self.left:,} left as they were; {self.failed:,} failed"


def _show(outcome: Outcome, as_json: bool) -> None:
    """A line of a unit, and one of each session and unit that could not be computed."""
    if outcome.done is None:
        assert outcome.failure is not None
        say(f"{outcome.unit}: {outcome.failure.reason}")
        return
    for one in outcome.done.kept:
        say(f"{outcome.unit}, session {one.session}: {one.why}")
    print_json(_as_json(outcome.done)) if as_json else _print_line(outcome.done)


def _as_json(done: Recalibrated) -> Json:
    names = ("unit", "sessions", "recomputed", "unchanged", "left", "revision")
    moved = [{"session": one.session, "before": one.before, "after": one.after} for one in done.verdicts]
    kept = [{"session": one.session, "why": one.why} for one in done.kept]
    return {name: getattr(done, name) for name in names} | {"verdicts": moved, "kept": kept}


def _print_line(done: Recalibrated) -> None:
    left = f", {done.left} cannot be computed under it" if done.left else ""
    other = f", {len(done.verdicts)} with another verdict" if done.verdicts else ""
    line = f"{done.recomputed} recomputed, {done.unchanged} unchanged{left}{other}; model revision {done.revision}"
    screen().print(f"[bold]{done.unit}[/]  {line}", highlight=False)
