"""Durable folders, and valid names of files in them."""

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
    """Whether it is a valid name of a stored file."""
    return isinstance(name, str) and NAME.fullmatch(name) is not None


def named_in(folder: Path, name: str) -> Path:
    """Path of a file of this name; every stored name becomes a path here, and nowhere else."""
    if not is_name(name):
        raise DamagedError(
            "{name} is not the name of a stored file: the record that names it was changed.", name=repr(name[:100])
        )
    return folder / name


def sync_folder(folder: Path) -> None:
    """Makes the names in a folder durable."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def make_folder(folder: Path) -> None:
    """Creates a folder and its missing parents, each durably."""
    if not folder.is_dir():
        make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)


PART = ".part-"
"""Prefix of a file that is still being written."""
LOCK_DELAY = 60.0
"""Seconds between creating a file and locking it, at most; a thousandth would do."""


@contextmanager
def written_whole(target: Path) -> Iterator[IO[bytes]]:
    """A file to write, synced and renamed when the block ends; removed when it raises.

    Locked until then. The caller makes the new name durable.
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
    """Syncs a complete file and renames it. The caller makes the new name durable."""
    with part.open("rb") as file:
        os.fsync(file.fileno())
    os.replace(part, target)


def sweep(folder: Path, pattern: str = f"{PART}*") -> int:
    """Removes half-written files of dead processes in a folder, and returns their number."""
    return sum(map(_remove_dead, folder.glob(pattern))) if folder.is_dir() else 0


def _remove_dead(part: Path) -> bool:
    """Whether its writer is dead and it was removed."""
    try:
        with part.open("rb") as file:
            if time.time() - os.fstat(file.fileno()).st_mtime < LOCK_DELAY:
                return False
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            part.unlink()
    except (FileNotFoundError, BlockingIOError):
        return False
    log.info("half-written file removed", file=part.name)
    return True


def require_writable(folder: Path) -> None:
    """Creates a missing folder; ServiceError with advice where it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with TemporaryFile(dir=folder):
            pass
    except OSError as fault:
        raise ServiceError(
            "The folder {folder} cannot be written: {strerror}. Give the service's user the right to "
            "write there, or name another one with --data-folder or IMU_HEALTH_DATA_FOLDER.",
            folder=folder,
            strerror=fault.strerror or fault,
        ) from fault


@dataclass(frozen=True)
class Space:
    """Free bytes, and the minimum for accepting an upload."""

    free: int
    least: int

    @property
    def too_little(self) -> str | None:
        """Reason why no upload is accepted; None while there is room."""
        if self.free >= self.least:
            return None
        return say(
            "The disk of uploaded files has {free} MiB left, less than the {least} MiB that are kept "
            "free, so no upload is taken. What is stored can be read as before.",
            free=f"{self.free / 2**20:.0f}",
            least=f"{self.least / 2**20:.0f}",
        )


def space_at(folder: Path, least: int) -> Space:
    """The space of a folder that may not exist yet."""
    existing = next(place for place in (folder, *folder.parents) if place.exists())
    return Space(shutil.disk_usage(existing).free, least)
