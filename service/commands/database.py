"""`imu-health db`, `backup`, `restore`: the schema's revisions, and one file with all stored data."""

import sys
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import typer

from estimator.wording import counted
from service.commands.options import DatabaseUrl, DataFolder, settings_from
from service.commands.speech import FAILED, many, say
from service.kit.person import COMMAND_LINE as WHO
from service.opening import open_database
from service.settings import Settings
from service.storage import Files
from service.storage.audit import Audit
from service.storage.backup import Restored, restore, verified, write_backup
from service.storage.backup.manifest import Manifest, RevokedAccess
from service.storage.backup.rows import INSTEAD
from service.storage.losses import Loss, losses
from service.storage.schema import downgrade, head_revision, upgrade

database = typer.Typer(
    name="db", add_completion=False, help="Bring the database's schema up or down.", no_args_is_help=True
)


@database.callback()
def _group() -> None:
    """Bring the database's schema up or down."""


@database.command("upgrade")
def upgrade_schema(
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
    back_to: Annotated[
        str, typer.Option(metavar="REVISION", help="Go back to an earlier one instead.", show_default=False)
    ] = "",
    yes: Annotated[bool, typer.Option("--yes", help="Do not ask; needed where nobody can answer.")] = False,
    no_backup: Annotated[bool, typer.Option("--no-backup", help="Write no backup into the data folder first.")] = False,
) -> None:
    """Bring the schema up to what this version needs; safe to run again. --back-to says what will be deleted, asks, and
    writes a backup first.
    """
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    if not back_to:
        upgrade(settings.database)
        typer.echo("The schema is at head.")
        return
    expected_losses = losses(settings.database, back_to)
    for loss in expected_losses:
        say(_lost_rows(loss))
    if expected_losses and not yes:
        _confirm()
    if expected_losses and not no_backup:
        _write_backup(settings)
    downgrade(settings.database, back_to)
    typer.echo(f"The schema is at {back_to}.")


def _confirm() -> None:
    """Goes on only after confirmation at a terminal."""
    if sys.stdin.isatty() and typer.confirm("Delete this?", err=True):
        return
    say("Nothing was changed. Say --yes to delete this.")
    raise typer.Exit(FAILED)


def _write_backup(settings: Settings) -> None:
    now = datetime.now(UTC)
    file = settings.data_folder / f"before-downgrade-{now:%Y%m%d-%H%M%S}.backup"
    lost = write_backup(settings.database, Files(settings.files), file, now).lost
    say(f"Backup: {file}" + (f", without {counted(len(lost), 'uploaded file')}, missing or damaged." if lost else "."))


def _lost_rows(loss: Loss) -> str:
    parts = [many(loss.rows, "row")] if loss.rows else []
    parts += [f"{column} of {many(rows, 'row')}" for column, rows in loss.values]
    return f"Will be deleted from {loss.table}: {', '.join(parts)}"


File = Annotated[Path, typer.Argument(metavar="FILE", help="The backup.", show_default=False)]


def backup(
    file: File,
    check: Annotated[
        bool, typer.Option("--check", help="Read one that is there, and compare it with its hashes.")
    ] = False,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Write all that is stored into one file, while the service runs; it is there whole or not at all."""
    if check:
        manifest = verified(file)
        typer.echo(f"{file} is whole: {_contents(manifest)}, made {manifest.made_at:%Y-%m-%d %H:%M} UTC.")
        return
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    manifest = write_backup(settings.database, Files(settings.files), file, datetime.now(UTC))
    typer.echo(f"{file}: {_contents(manifest)}.")
    if manifest.lost:
        lost, is_one = counted(len(manifest.lost), "uploaded file"), len(manifest.lost) == 1
        say(f"{lost} {'is' if is_one else 'are'} missing or damaged and not in it: {', '.join(manifest.lost)}.")
        raise typer.Exit(FAILED)


def restore_backup(
    file: File,
    revoke_tokens: Annotated[
        bool, typer.Option("--revoke-tokens", help="Let no token in that the backup brings back.")
    ] = False,
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Put a backup into an empty database, of either kind, and an empty data folder. Everybody must sign in again."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    now = datetime.now(UTC)
    restored = restore(file, settings.database, settings.files, now, revoke_tokens=revoke_tokens)
    _record_restore(settings.database, restored, now)
    typer.echo(f"Restored {_contents(restored.manifest)}.")
    _report_access(restored.access)
    for place, count in restored.changed.items():
        say(f"{place}: {counted(count, 'text')} held NUL, which PostgreSQL refuses: {INSTEAD} stands for it now.")


def _record_restore(url: str, restored: Restored, now: datetime) -> None:
    """Records the restore in the audit trail, which an earlier schema may not have."""
    if restored.manifest.revision != head_revision():
        return
    database = open_database(url)
    with database.writing() as store:
        made_at, changed = restored.manifest.made_at.isoformat(), dict(restored.changed)
        details = {"made_at": made_at, **vars(restored.access), "changed": changed}
        Audit(store).write(now, WHO, "restore", "backup", details)
    database.close()


def _report_access(access: RevokedAccess) -> None:
    if access.browsers:
        say(f"{counted(access.browsers, 'signed-in browser')} {'was' if access.browsers == 1 else 'were'} signed out.")
    if access.tokens and access.revoked:
        say(f"{counted(access.tokens, 'token')} {'was' if access.tokens == 1 else 'were'} revoked: make new ones.")
    elif access.tokens:
        say(
            f"{counted(access.tokens, 'token')} {'holds' if access.tokens == 1 else 'hold'} again, revoked since the "
            "backup or not: look at `imu-health user list --tokens`. --revoke-tokens would have revoked them all."
        )


def _contents(manifest: Manifest) -> str:
    rows = sum(table.rows for table in manifest.tables)
    return f"{many(rows, 'row')}, {many(len(manifest.files), 'file')}, schema {manifest.revision}"
