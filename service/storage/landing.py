"""Bytes that arrive in parts: in memory while they are few, then in a file next to the stored ones."""

import fcntl
import hashlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import IO

from service.kit.arriving_files import Content, Landed
from service.kit.log import log
from service.storage.faults import disk_faults
from service.storage.folders import PART, make_folder

IN_MEMORY = 256 * 1024
"""Bytes that are held in memory: a session of positions has a tenth, and a form may bring 200 files."""
AT_ONCE = 1024 * 1024
"""Bytes that are written at a time."""
START = 64
"""Bytes: more than the signature of any format, blank lines before the metadata of a CSV included."""
ARRIVING = "arriving"
"""Folder of arriving files, on the disk of the stored ones, so that a file is stored by renaming it."""


def file_hash(path: Path) -> str:
    """The SHA-256 of a file, hexadecimal, without holding it in memory."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


class Landing:
    """One arriving file."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._file: IO[bytes] | None = None
        self._waiting, self._hash = bytearray(), hashlib.sha256()
        self.size = 0
        self.start = b""
        """First bytes, from which the format is recognised."""

    @property
    def is_due(self) -> bool:
        """Whether enough is buffered to be written now."""
        return len(self._waiting) >= (IN_MEMORY if self._file is None else AT_ONCE)

    def take(self, data: bytes) -> None:
        """Buffers more of it; nothing is written yet."""
        self._waiting += data
        self.size += len(data)
        if len(self.start) < START:
            self.start = bytes(self._waiting[:START])

    def write(self) -> None:
        """Writes the buffer to the file."""
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
        """All of it, after the last part: bytes, or a complete file that is not yet durable."""
        if self._file is None:
            return bytes(self._waiting)
        if self._waiting:
            self.write()
        return Landed(Path(self._file.name), self._hash.hexdigest(), self.size)

    def made(self, make: Callable[[IO[bytes]], None]) -> Landed:
        """The file that is made in its place."""
        self.write()
        assert self._file is not None
        with disk_faults():
            make(self._file)
            self._file.flush()
            path = Path(self._file.name)
            return Landed(path, file_hash(path), path.stat().st_size)

    def close(self) -> None:
        """Removes the file, unless it was stored and has another name by now.

        On a full disk the rest of the buffer fails once more, and a file that stays is swept later: neither concerns
        the answer.
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
    """A place for arriving files; what was not stored is removed at the end."""
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
        """A place for one more file."""
        self._all.append(Landing(self._folder))
        return self._all[-1]

    def close(self) -> None:
        """Removes what was not stored."""
        for landing in self._all:
            landing.close()
