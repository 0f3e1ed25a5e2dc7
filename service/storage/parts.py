"""Files that appear complete or not at all, and the rests of those whose writer died."""

import fcntl
import os
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import IO

from service.kit.log import log

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
