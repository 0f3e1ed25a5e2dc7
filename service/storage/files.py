"""Uploaded bytes, unchanged, under the name of their hash; safe on disk before the database knows of them."""

import fcntl
import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import NamedTemporaryFile

from service.errors import DamagedError, NotFoundError
from service.log import log
from service.storage.faults import disk_faults
from service.storage.folders import make_folder, sync_folder

PART = ".part-"
"""Begins the name of a file that is still being written."""
LOST = (NotFoundError, DamagedError)
"""What reading a file may end in although it was stored."""
YOUNG = 60.0
"""Seconds in which a file may be made but not yet held by the one who writes it; a thousandth would do."""


def content_hash(content: bytes) -> str:
    """SHA-256, 64 hexadecimal digits."""
    return sha256(content).hexdigest()


def _ignore(_: str) -> None:
    """Nobody counts."""


@dataclass(frozen=True)
class Files:
    """A folder of uploads."""

    folder: Path
    count: Callable[[str], None] = _ignore
    """Is told of every file that is "missing", "damaged" or "put back"."""

    def path(self, digest: str) -> Path:
        """Where the bytes of a hash are kept; made from the hash alone, never from an uploaded name."""
        return self.folder / digest[:2] / digest

    def keep(self, content: bytes) -> str:
        """Stores the bytes so that they survive a power cut, and returns their hash.

        Kept again they stay as they are, or are put back if they were lost or damaged. The names are made durable in
        any case: another upload may have put the file there and died before it could.
        """
        digest = content_hash(content)
        target = self.path(digest)
        with disk_faults():
            if not self._holds(target, digest):
                make_folder(target.parent)
                _write_whole(target, content)
            for folder in (target.parent, self.folder, self.folder.parent):
                sync_folder(folder)
        return digest

    def put_back(self, content: bytes) -> None:
        """Keeps bytes again that were stored before, and says so where they were lost or damaged."""
        digest = content_hash(content)
        is_whole = self._holds(self.path(digest), digest)
        self.keep(content)
        if not is_whole:
            log.warning("file put back", sha256=digest)
            self.count("put back")

    def read(self, digest: str) -> bytes:
        """The bytes as they were uploaded; NotFoundError where they are gone, DamagedError where they were changed."""
        try:
            content = self.path(digest).read_bytes()
        except FileNotFoundError as missing:
            self._tell("missing", digest)
            raise NotFoundError(
                f"The uploaded file {digest} is missing from {self.folder}. Uploading the same file puts it back."
            ) from missing
        except OSError as fault:
            self._tell("unreadable", digest)
            raise DamagedError(f"The uploaded file {digest} cannot be read: {fault.strerror or fault}.") from fault
        if content_hash(content) != digest:
            self._tell("damaged", digest)
            raise DamagedError(
                f"The stored file {digest} is not what was uploaded: its content was changed, so it is not given out. "
                "Uploading the same file, or the one in a backup, puts it back."
            )
        return content

    def sweep(self) -> int:
        """Removes what dead processes left half written, and returns how many; whoever still writes holds a lock."""
        if not self.folder.is_dir():
            return 0
        with disk_faults():
            return sum(_remove_dead(part) for part in self.folder.glob(f"*/{PART}*"))

    def _holds(self, target: Path, digest: str) -> bool:
        """Whether the file is there as it was uploaded."""
        try:
            return content_hash(target.read_bytes()) == digest
        except OSError:
            return False

    def _tell(self, fault: str, digest: str) -> None:
        log.error("stored file unusable", fault=fault, sha256=digest)
        self.count(fault)


def _write_whole(target: Path, content: bytes) -> None:
    """Under another name first: the file appears complete or not at all."""
    with NamedTemporaryFile(dir=target.parent, prefix=PART, delete=False) as part:
        try:
            fcntl.flock(part, fcntl.LOCK_EX)
            part.write(content)
            part.flush()
            os.fsync(part.fileno())
            os.replace(part.name, target)
        except OSError:
            Path(part.name).unlink(missing_ok=True)
            raise


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
