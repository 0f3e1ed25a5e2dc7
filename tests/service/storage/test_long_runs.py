"""The proofs of durability over hours work at their smallest: a kill of everything, and a few uploads."""

from pathlib import Path

from benchmarks.kills.__main__ import Chosen, killed
from benchmarks.kills.database import kill_of_all
from benchmarks.soak import soaked
from service.settings import Settings
from tests.databases import Databases, PostgresDatabases


def test_the_database_s_server_is_killed_between_uploads_and_nothing_is_lost(
    postgresql: PostgresDatabases, tmp_path: Path
) -> None:
    settings = Settings(database_url=postgresql.migrated(), data_folder=tmp_path)
    before = postgresql.server.get_pid()
    seen = killed("postgresql-server", settings, kill_of_all(postgresql), Chosen(1, seed=1, longest=0.1, uploads=1))
    assert postgresql.server.get_pid() != before
    assert len(seen.load.acknowledged) >= 2
    assert (seen.faults, seen.load.refused, seen.database_kills) == ([], [], 1)


def test_a_long_run_is_looked_at_on_its_way(sqlite: Databases, tmp_path: Path) -> None:
    seen = soaked(Settings(database_url=sqlite.migrated(), data_folder=tmp_path), 3)
    assert [uploads for uploads, _, _ in seen] == [1, 2, 3]
    assert all(memory > 10 and handles > 3 for _, memory, handles in seen)
