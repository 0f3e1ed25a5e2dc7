"""`imu-health db`: the schema's revisions."""

from typing import Annotated

import typer

from service.commands.options import DatabaseUrl, DataFolder, settings_from
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


@database.command("downgrade")
def downgrade_schema(
    revision: Annotated[str, typer.Argument(help="Revision to go down to, for instance -1 or base.")],
    database_url: DatabaseUrl = None,
    data_folder: DataFolder = None,
) -> None:
    """Take the schema back to an earlier revision; what later ones added is lost."""
    settings = settings_from(database_url=database_url, data_folder=data_folder)
    downgrade(settings.database, revision)
    typer.echo(f"The schema is at {revision}.")
