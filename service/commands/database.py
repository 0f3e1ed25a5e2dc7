"""`imu-health db`: the schema's revisions."""

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from estimator.wording import counted
from service.commands.exits import FAILED, many, say
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.settings import Settings
from service.storage import Files
from service.storage.backup import write_backup
from service.storage.losses import Loss, losses
from service.storage.schema import downgrade, upgrade

database = typer.Typer(
    name="db", add_completion=False, help="Bring the database's schema up or down.", no_args_is_help=True
)


@database.command("upgrade")
def upgrade_schema(
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    revision: Annotated[str, typer.Option(help="Revision to go up to.")] = "head",
) -> None:
    """Bring the schema up to what this version needs; safe to run again."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    upgrade(settings.database, revision)
    typer.echo(f"The schema is at {revision}.")


@database.command("downgrade", context_settings={"ignore_unknown_options": True})
def downgrade_schema(
    revision: Annotated[str, typer.Argument(help="Revision to go down to, for instance -1 or base.")],
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask; needed where nobody can answer.")] = False,
    backup: Annotated[
        Path | None, typer.Option(help="Where to write a backup first.", show_default="a new file in the data folder")
    ] = None,
    no_backup: Annotated[bool, typer.Option("--no-backup", help="Write no backup first.")] = False,
) -> None:
    """Take the schema back to an earlier revision; says what will be deleted, asks, and writes a backup first."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    found = losses(settings.database, revision)
    for loss in found:
        say(_told(loss))
    if found and not yes:
        _ask()
    if found and not no_backup:
        _write_backup(settings, backup)
    downgrade(settings.database, revision)
    typer.echo(f"The schema is at {revision}.")


def _ask() -> None:
    """Goes on only when a person at a terminal says so."""
    if sys.stdin.isatty() and typer.confirm("Delete this?", err=True):
        return
    say("Nothing was changed. Say --yes to delete this.")
    raise typer.Exit(FAILED)


def _write_backup(settings: Settings, target: Path | None) -> None:
    now = datetime.now(UTC)
    file = target or settings.data_folder / f"before-downgrade-{now:%Y%m%d-%H%M%S}.backup"
    lost = write_backup(settings.database, Files(settings.files), file, now).lost
    say(f"Backup: {file}" + (f", without {counted(len(lost), 'uploaded file')}, missing or damaged." if lost else "."))


def _told(loss: Loss) -> str:
    """What would be gone of a table."""
    parts = [many(loss.rows, "row")] if loss.rows else []
    parts += [f"{column} of {many(rows, 'row')}" for column, rows in loss.values]
    return f"Will be deleted from {loss.table}: {', '.join(parts)}"
