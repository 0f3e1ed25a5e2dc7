"""Bytes that come in parts: into memory while they are few, then into a file beside those that are kept."""

import fcntl
import hashlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import IO

from service.kit.arriving_files import Content, Landed
from service.kit.log import log
from service.storage.faults import disk_faults
from service.storage.folders import PART, make_folder

IN_MEMORY = 256 * 1024
"""Bytes that are held: a session of positions has a tenth, and a form may bring 200 files."""
AT_ONCE = 1024 * 1024
"""Bytes that are written at a time."""
START = 64
"""Bytes: more than any format's beginning, blank lines before the metadata of a CSV included."""
ARRIVING = "arriving"
"""Folder of what comes, on the disk of what is kept, so that a file is kept by giving it another name."""


class Landing:
    """One file that comes."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file: IO[bytes] | None = None
        self._waiting, self._hash = bytearray(), hashlib.sha256()
        self.size = 0
        self.start = b""
        """The first bytes, by which a format is told."""

    @property
    def is_due(self) -> bool:
        """Whether so much waits that it is to be written now."""
        return len(self._waiting) >= (IN_MEMORY if self._file is None else AT_ONCE)

    def take(self, data: bytes) -> None:
        """More of it; nothing is written yet."""
        self._waiting += data
        self.size += len(data)
        if len(self.start) < START:
            self.start = bytes(self._waiting[:START])

    def write(self) -> None:
        """Puts what waits into the file."""
        with disk_faults():
            if self._file is None:
                make_folder(self._folder)
                self._file = NamedTemporaryFile(dir=self._folder, prefix=PART, delete=False)  # noqa: SIM115 - `close`
                fcntl.flock(self._file, fcntl.LOCK_EX)
            self._file.write(self._waiting)
            self._hash.update(self._waiting)
            self._waiting.clear()
            self._file.flush()

    def landed(self) -> Content:
        """All of it, once the last part was taken: bytes, or a file that is whole but not yet durable."""
        if self._file is None:
            return bytes(self._waiting)
        if self._waiting:
            self.write()
        return Landed(Path(self._file.name), self._hash.hexdigest(), self.size)

    def close(self) -> None:
        """Removes the file, unless it was kept and has another name by now.

        Where the disk is full what waits to be written fails once more, and a name that stays is swept later: neither
        is the answer.
        """
        if self._file is None:
            return
        with suppress(OSError):
            self._file.close()
        try:
            Path(self._file.name).unlink(missing_ok=True)
        except OSError as fault:
            log.warning("file that came is left behind", file=self._file.name, reason=str(fault))


@contextmanager
def landings(folder: Path) -> Iterator["Landings"]:
    """A place where files land; what was not kept is gone at the end."""
    place = Landings(folder / ARRIVING)
    try:
        yield place
    finally:
        place.close()


class Landings:
    """The files of one request."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._all: list[Landing] = []

    def new(self) -> Landing:
        """For one more file."""
        self._all.append(Landing(self._folder))
        return self._all[-1]

    def close(self) -> None:
        """Removes what was not kept."""
        for landing in self._all:
            landing.close()
