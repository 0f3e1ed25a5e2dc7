"""`imu-health recalibrate`: stored sessions computed again under the models in force, directly in the database."""

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
from service.records.many import Run, UnitOutcome, by_workers, can_share, one_by_one, units_behind
from service.records.recalibrate import Recalibrated
from service.settings import Settings
from service.storage import Storage

WORTH_STARTING = 100
"""Units for which other processes are started by default: their start takes some five seconds."""
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
class Processes:
    """Processes of the computation."""

    workers: int | None
    scheduler: str | None
    quiet: bool
    """Whether the progress bar is left out."""


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
    totals = _Totals()
    for outcome in _outcomes(storage, settings, units, Processes(workers, scheduler, as_json)):
        totals.add(outcome)
        _show(outcome, as_json)
    storage.database.close()
    if not as_json:
        screen().print(totals.in_words(), highlight=False)
    if totals.failed:
        raise typer.Exit(FAILED)


def _outcomes(
    storage: Storage, settings: Settings, units: list[str] | None, processes: Processes
) -> Iterator[UnitOutcome]:
    with storage.database.reading() as store:
        count = len(units) if units else Models(store).count_behind()
    serials: Iterable[str] = units or units_behind(storage)
    with (
        progress(count, "recalibrating", quiet=processes.quiet) as advance,
        _run(storage, settings, count, processes) as run,
    ):
        for outcome in run(serials):
            yield outcome
            advance()


def _run(storage: Storage, settings: Settings, count: int, processes: Processes) -> AbstractContextManager[Run]:
    def clock() -> datetime:
        return datetime.now(UTC)

    is_worthwhile = count >= WORTH_STARTING and can_share()
    workers = processes.workers or ((os.cpu_count() or 1) if is_worthwhile else 1)
    if processes.scheduler is None and workers == 1:
        return nullcontext(one_by_one(storage, clock, settings.coverage_factor))
    return by_workers(storage, settings, clock, workers=workers, scheduler=processes.scheduler)


class _Totals:
    def __init__(self) -> None:
        self.units = self.failed = self.recomputed = self.left = self.moved = 0

    def add(self, outcome: UnitOutcome) -> None:
        self.units += 1
        if outcome.done is None:
            self.failed += 1
        else:
            self.recomputed += outcome.done.recomputed
            self.left += outcome.done.left
            self.moved += len(outcome.done.verdicts)

    def in_words(self) -> str:
        """``2 units: 12 sessions recomputed, 1 with another verdict, 0 left, 0 units failed``."""
        if not self.units:
            return "Nothing to do: every session is computed under the model that concerns it."
        summary = f"{many(self.recomputed, 'session')} recomputed, {self.moved:,} with another verdict"
        return f"{many(self.units, 'unit')}: {summary}, {self.left:,} left as they were; {self.failed:,} failed"


def _show(outcome: UnitOutcome, as_json: bool) -> None:
    """A line of a unit, and one of each session and unit that could not be computed."""
    if outcome.done is None:
        assert outcome.failure is not None
        say(f"{outcome.unit}: {outcome.failure.reason}")
        return
    for session in outcome.done.kept:
        say(f"{outcome.unit}, session {session.session}: {session.why}")
    print_json(_as_json(outcome.done)) if as_json else _print_line(outcome.done)


def _as_json(done: Recalibrated) -> Json:
    names = ("unit", "sessions", "recomputed", "unchanged", "left", "revision")
    changes = [{"session": item.session, "before": item.before, "after": item.after} for item in done.verdicts]
    kept = [{"session": item.session, "why": item.why} for item in done.kept]
    return {name: getattr(done, name) for name in names} | {"verdicts": changes, "kept": kept}


def _print_line(done: Recalibrated) -> None:
    remainder = f", {done.left} cannot be computed under it" if done.left else ""
    changes = f", {len(done.verdicts)} with another verdict" if done.verdicts else ""
    line = (
        f"{done.recomputed} recomputed, {done.unchanged} unchanged{remainder}{changes}; model revision {done.revision}"
    )
    screen().print(f"[bold]{done.unit}[/]  {line}", highlight=False)
