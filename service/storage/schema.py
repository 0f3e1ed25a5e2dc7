"""The schema's revisions: Alembic from the installed package, without a file of settings."""

from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache

from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from alembic.util import CommandError
from sqlalchemy import Connection, text

from service.errors import ServiceError
from service.storage.engine import WRITES, open_engine
from service.storage.faults import database_faults
from service.storage.waits import PATIENT

MIGRATION_LOCK = 0x696D_7568
"""Key of PostgreSQL's advisory lock: the letters "imuh", so that no other program takes it by chance."""


def migrations(connection: Connection | None = None) -> Config:
    """Alembic's settings; its scripts are the package `migrations`."""
    config = Config()
    config.set_main_option("script_location", "migrations:")
    config.attributes["connection"] = connection
    return config


@contextmanager
def alone(url: str) -> Iterator[Connection]:
    """A transaction with exclusive access to the schema: others wait until it ends.

    SQLite has one writer at a time anyway, and its transaction takes the write lock at once.
    """
    engine = open_engine(url, PATIENT)
    try:
        with database_faults(), engine.execution_options(**{WRITES: True}).begin() as connection:
            if connection.dialect.name == "postgresql":
                connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": MIGRATION_LOCK})
            yield connection
    finally:
        engine.dispose()


def upgrade(url: str, revision: str = "head") -> None:
    """Upgrades the schema to a revision; no-op where the database is there already."""
    with alone(url) as connection:
        raise_to(connection, revision)


def downgrade(url: str, revision: str) -> None:
    """Downgrades the schema to a revision; what later ones added is deleted."""
    with alone(url) as connection:
        take_back(connection, revision)


def raise_to(connection: Connection, revision: str) -> None:
    """Upgrades the schema to a revision within a transaction of the caller."""
    with _known_revisions(connection, revision):
        command.upgrade(migrations(connection), revision)


def take_back(connection: Connection, revision: str) -> None:
    """Downgrades the schema to a revision within a transaction of the caller."""
    with _known_revisions(connection, revision):
        command.downgrade(migrations(connection), revision)


@contextmanager
def _known_revisions(connection: Connection, wanted: str) -> Iterator[None]:
    current = stored_revision(connection)
    if current is not None and not is_known(current):
        raise ServiceError(
            f"The database's schema is at {current}, which this version does not know: a newer version made it. "
            f"Nothing was changed. Start that version; this one goes up to {head_revision()}."
        )
    try:
        yield
    except CommandError as fault:
        raise ServiceError(f"The schema cannot be brought to {wanted!r}: {fault}. Nothing was changed.") from fault


@cache
def head_revision() -> str | None:
    """The revision that this version of the program needs."""
    return ScriptDirectory.from_config(migrations()).get_current_head()


def is_known(revision: str) -> bool:
    """Whether this version has the migration to a revision."""
    return any(script.revision == revision for script in ScriptDirectory.from_config(migrations()).walk_revisions())


def stored_revision(connection: Connection) -> str | None:
    """The revision of the database; None for an empty one."""
    return MigrationContext.configure(connection).get_current_revision()
