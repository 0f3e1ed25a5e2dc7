"""Every call of an upload that can fail fails once, the first, the second, until none is left: the upload is not
acknowledged and nothing is there by halves, and sent again it is stored once."""

import errno
import os
import resource
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC, datetime
from itertools import count
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import Connection, event
from sqlalchemy.exc import OperationalError

from service.errors import AwayError
from service.settings import Settings
from service.storage import Files, Storage
from tests.databases import ENGINES
from tests.service.made_sessions import session_bytes
from tests.service.storage.intact import SENSORS, faults
from tests.service.storage.sending import Way, as_bytes, landed

NOW = datetime(2026, 11, 21, 12, tzinfo=UTC)
CALLS = ("open", "mkdir", "fsync", "replace", "unlink")
"""Calls that change the folder of files."""

STEP = 4
"""Every fourth statement of PostgreSQL fails: they are the same as SQLite's, of which each does."""


@dataclass
class Failing:
    """Lets one call fail, the n-th."""

    left: int

    def due(self) -> bool:
        """Whether this call is the one that fails."""
        self.left -= 1
        return self.left == 0

    @property
    def happened(self) -> bool:
        """Whether there were so many calls."""
        return self.left <= 0


def refused(_: object = None) -> OperationalError:
    """The error of a driver whose server is gone."""
    return OperationalError("", {}, Exception("the server is gone"))


@contextmanager
def failing_disk(_: Storage, nth: Failing) -> Iterator[None]:
    """The n-th call that changes a folder fails."""
    with pytest.MonkeyPatch.context() as patch:
        for name in CALLS:
            patch.setattr(os, name, _once(getattr(os, name), nth))
        yield


def _once(call: Callable[..., Any], nth: Failing) -> Callable[..., Any]:
    def called(*given: Any, **named: Any) -> Any:
        if ("/files" in str(given[0]) or isinstance(given[0], int)) and nth.due():
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return call(*given, **named)

    return called


@contextmanager
def failing_statements(storage: Storage, nth: Failing) -> Iterator[None]:
    """The n-th statement fails; a commit is one too."""

    def look(*_: Any) -> None:
        if nth.due():
            raise refused()

    with listening(storage, "before_cursor_execute", look), listening(storage, "commit", look):
        yield


@contextmanager
def lost_answers(storage: Storage, nth: Failing) -> Iterator[None]:
    """The n-th commit is done, and its answer lost."""

    def commit(connection: Connection) -> None:
        if nth.due():
            connection.connection.commit()
            raise refused()

    with listening(storage, "commit", commit):
        yield


@contextmanager
def listening(storage: Storage, what: str, to: Callable[..., Any]) -> Iterator[None]:
    """Calls something when the database does something."""
    event.listen(storage.database.engine, what, to)
    try:
        yield
    finally:
        event.remove(storage.database.engine, what, to)


SLOW = (
    ("sqlite", failing_disk, landed),
    *((engine, failing_statements, as_bytes) for engine in ENGINES),
    ("sqlite", lost_answers, as_bytes),
)


@pytest.mark.parametrize(
    ("databases", "failing", "send"),
    [
        ("sqlite", failing_disk, as_bytes),
        ("postgresql", lost_answers, as_bytes),
        *(pytest.param(*case, marks=pytest.mark.slow) for case in SLOW),
    ],
    indirect=["databases"],
)
def test_after_every_single_failure_an_upload_is_whole_or_not_there_and_is_stored_once_when_repeated(
    storage: Storage, settings: Settings, failing: Callable[..., Any], send: Way
) -> None:
    done: list[bytes] = []
    step = STEP if failing is failing_statements and storage.database.engine.name == "postgresql" else 1
    for n in count(1, step):
        content, nth = session_bytes(seed=n, unit=f"FC-{n}", m=SENSORS), Failing(n)
        try:
            with failing(storage, nth):
                send(storage, content, NOW)
        except (AwayError, OperationalError):
            assert faults(settings, done, [*done, content]) == []
        send(storage, content, NOW)
        done.append(content)
        if not nth.happened:
            break
    assert n > 1
    assert faults(settings, done, done) == []


@contextmanager
def no_file_longer_than(size: int) -> Iterator[None]:
    """Limits the size of files, as a disk does that fills up."""
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)


def left(folder: Path) -> list[Path]:
    """Every file in a folder."""
    return [path for path in folder.rglob("*") if path.is_file()]


def test_a_file_that_cannot_grow_is_not_there_and_is_whole_when_kept_again(tmp_path: Path) -> None:
    files, content = Files(tmp_path), bytes(10_000)
    with no_file_longer_than(100), pytest.raises(AwayError):
        files.keep(content)
    assert left(tmp_path) == []
    assert files.read(files.keep(content)) == content


@pytest.mark.parametrize("size", [100, 9_900], ids=["at once", "with its last bytes"])
def test_a_file_that_cannot_land_leaves_nothing(tmp_path: Path, size: int) -> None:
    with no_file_longer_than(size), pytest.raises(AwayError):
        land(Files(tmp_path), bytes(10_000))
    assert left(tmp_path) == []


def land(files: Files, content: bytes) -> None:
    """Nobody keeps it."""
    with files.arriving() as place:
        landing = place.new()
        landing.take(content)
        landing.write()
