"""The schema's revisions: Alembic from the installed package, without a file of settings."""

from functools import cache

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection

from service.storage.engine import WRITES, open_engine
from service.storage.faults import database_faults


def migrations(connection: Connection | None = None) -> Config:
    """Alembic's settings; its scripts are the package `migrations`."""
    config = Config()
    config.set_main_option("script_location", "migrations:")
    config.attributes["connection"] = connection
    return config


def upgrade(url: str, revision: str = "head") -> None:
    """Brings the schema up to a revision; a database that is there already is left alone."""
    engine = open_engine(url)
    with database_faults(), engine.execution_options(**{WRITES: True}).begin() as connection:
        command.upgrade(migrations(connection), revision)
    engine.dispose()


def downgrade(url: str, revision: str) -> None:
    """Takes the schema back to a revision; what later ones added is gone."""
    engine = open_engine(url)
    with database_faults(), engine.execution_options(**{WRITES: True}).begin() as connection:
        command.downgrade(migrations(connection), revision)
    engine.dispose()


@cache
def head_revision() -> str | None:
    """The revision that this version of the program needs."""
    return ScriptDirectory.from_config(migrations()).get_current_head()


def stored_revision(connection: Connection) -> str | None:
    """The revision that the database is at; None for an empty one."""
    return MigrationContext.configure(connection).get_current_revision()
