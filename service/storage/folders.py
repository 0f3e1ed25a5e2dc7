"""Folders whose names survive a power cut, and the names that may stand in them."""

import fcntl
import os
import re
import shutil
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from tempfile import NamedTemporaryFile, TemporaryFile
from typing import IO

from estimator.message import say
from service.errors import DamagedError, ServiceError
from service.kit.log import log

NAME = re.compile(r"[0-9a-z][0-9a-z-]{0,99}")
"""Hashes, numbers and identifiers: nothing that leads out of a folder."""


def is_name(name: object) -> bool:
    """Whether a stored file may be called so."""
    return isinstance(name, str) and NAME.fullmatch(name) is not None


def named_in(folder: Path, name: str) -> Path:
    """Where a file of this name lies; every name that is stored becomes a path here, and nowhere else."""
    if not is_name(name):
        raise DamagedError(
            say("{name} is not the name of a stored file: the record that names it was changed.", name=repr(name[:100]))
        )
    return folder / name


def sync_folder(folder: Path) -> None:
    """Makes the names in a folder durable."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def make_folder(folder: Path) -> None:
    """Makes a folder and those above it that are missing, each durably."""
    if not folder.is_dir():
        make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)


PART = ".part-"
"""Begins the name of a file that is still being written."""
YOUNG = 60.0
"""Seconds in which a file may be made but not yet held by the one who writes it; a thousandth would do."""


@contextmanager
def written_whole(target: Path) -> Iterator[IO[bytes]]:
    """A file to write, synced and given its name when the block ends; gone when it raises.

    It is held by a lock until then. The name itself is made durable by the caller.
    """
    with NamedTemporaryFile(dir=target.parent, prefix=PART, delete=False) as part:
        try:
            fcntl.flock(part, fcntl.LOCK_EX)
            yield part.file
            part.flush()
            os.fsync(part.fileno())
            os.replace(part.name, target)
        except BaseException:
            Path(part.name).unlink(missing_ok=True)
            raise


def named_durably(part: Path, target: Path) -> None:
    """Syncs a file that was written whole and gives it its name. The name itself is made durable by the caller."""
    with part.open("rb") as file:
        os.fsync(file.fileno())
    os.replace(part, target)


def sweep(folder: Path, pattern: str = f"{PART}*") -> int:
    """Removes what dead processes left half written in a folder, and returns how many files that were."""
    return sum(map(_remove_dead, folder.glob(pattern))) if folder.is_dir() else 0


def _remove_dead(part: Path) -> bool:
    """Whether it was nobody's any more, and is gone."""
    try:
        with part.open("rb") as file:
            if time.time() - os.fstat(file.fileno()).st_mtime < YOUNG:
                return False
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            part.unlink()
    except (FileNotFoundError, BlockingIOError):
        return False
    log.info("half-written file removed", file=part.name)
    return True


def require_writable(folder: Path) -> None:
    """Makes the folder where it is missing; ServiceError that says what to do where nothing can be written there."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as fault:
        raise ServiceError(
            say(
                "The folder {folder} cannot be written: {strerror}. Give the service's user the right to "
                "write there, or name another one with --data-folder or IMU_HEALTH_DATA_FOLDER.",
                folder=folder,
                strerror=fault.strerror or fault,
            )
        ) from fault


@dataclass(frozen=True)
class Space:
    """Bytes that are free, and below which no upload is taken."""

    free: int
    least: int

    @property
    def too_little(self) -> str | None:
        """Why no upload is taken; None while there is room."""
        if self.free >= self.least:
            return None
        return say(
            "The disk of uploaded files has {free} MiB left, less than the {least} MiB that are kept "
            "free, so no upload is taken. What is stored can be read as before.",
            free=f"{self.free / 2**20:.0f}",
            least=f"{self.least / 2**20:.0f}",
        )


def space_at(folder: Path, least: int) -> Space:
    """The room of a folder that may not be made yet."""
    made = next(place for place in (folder, *folder.parents) if place.exists())
    return Space(shutil.disk_usage(made).free, least)
