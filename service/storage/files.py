"""Uploaded bytes, unchanged, named by their hash; durable before the database refers to them."""

from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from service.errors import DamagedError, NotFoundError
from service.kit.arriving_files import Content, Landed
from service.kit.log import log
from service.storage.faults import disk_faults
from service.storage.folders import PART, make_folder, named_durably, named_in, sweep, sync_folder, written_whole
from service.storage.landing import IN_MEMORY, Landings, file_hash, landings

LOST = (NotFoundError, DamagedError)
"""Raised on reading a stored file that is missing or damaged."""


def content_hash(content: Content) -> str:
    """SHA-256, 64 hexadecimal digits."""
    return content.sha256 if isinstance(content, Landed) else sha256(content).hexdigest()


def no_op(_: str) -> None:
    """No-op."""


@dataclass(frozen=True)
class Files:
    """A folder of uploads."""

    folder: Path
    count: Callable[[str], None] = no_op
    """Counts files that are "missing", "damaged" or "put back"."""

    def path(self, digest: str) -> Path:
        """Path of the bytes of a hash; made from the hash alone, never from an uploaded name."""
        return named_in(self.folder / digest[:2], digest)

    def keep(self, content: Content) -> str:
        """Stores the bytes durably, and returns their hash.

        Stored again they stay as they are, or are restored if they were missing or damaged. The names are made durable
        in any case: another upload may have put the file there and died before it could.
        """
        digest = content_hash(content)
        target = self.path(digest)
        with disk_faults():
            if not self._holds(target, digest):
                make_folder(target.parent)
                _put(content, target)
            for folder in (target.parent, self.folder, self.folder.parent):
                sync_folder(folder)
        return digest

    def put_back(self, content: Content) -> None:
        """Stores bytes that were stored before, and logs where they were missing or damaged."""
        digest = content_hash(content)
        is_whole = self._holds(self.path(digest), digest)
        self.keep(content)
        if not is_whole:
            log.warning("file put back", sha256=digest)
            self.count("put back")

    def read(self, digest: str) -> bytes:
        """The bytes as they were uploaded; NotFoundError for a missing file, DamagedError for a changed one."""
        with self._found(digest):
            content = self.path(digest).read_bytes()
        self._check(content_hash(content), digest)
        return content

    def content(self, digest: str) -> bytes | Path:
        """The bytes of a stored file; for a long file its path, after its bytes were checked."""
        with self._found(digest):
            if self.path(digest).stat().st_size <= IN_MEMORY:
                return self.read(digest)
            actual = file_hash(self.path(digest))
        self._check(actual, digest)
        return self.path(digest)

    def arriving(self) -> AbstractContextManager[Landings]:
        """A place for files that arrive in parts."""
        return landings(self.folder)

    @contextmanager
    def _found(self, digest: str) -> Iterator[None]:
        try:
            yield
        except FileNotFoundError as missing:
            self._report_fault("missing", digest)
            raise NotFoundError(
                "The uploaded file {digest} is missing from {folder}. Upload the same file to restore it.",
                digest=digest,
                folder=self.folder,
            ) from missing
        except OSError as fault:
            self._report_fault("unreadable", digest)
            raise DamagedError(
                "The uploaded file {digest} cannot be read: {strerror}.",
                digest=digest,
                strerror=fault.strerror or fault,
            ) from fault

    def _check(self, actual: str, digest: str) -> None:
        if actual != digest:
            self._report_fault("damaged", digest)
            raise DamagedError(
                "The stored file {digest} is not what was uploaded: its content was changed, so it cannot be "
                "downloaded. Upload the same file, or the one in a backup, to restore it.",
                digest=digest,
            )

    def sweep(self) -> int:
        """Removes half-written files of dead processes, and returns their number; a living writer holds a lock."""
        with disk_faults():
            return sweep(self.folder, f"*/{PART}*")

    def _holds(self, target: Path, digest: str) -> bool:
        """Whether the file is there as it was uploaded."""
        try:
            return file_hash(target) == digest
        except OSError:
            return False

    def _report_fault(self, fault: str, digest: str) -> None:
        log.error("stored file unusable", fault=fault, sha256=digest)
        self.count(fault)


def _put(content: Content, target: Path) -> None:
    """The bytes under their name; a landed file is moved there."""
    if isinstance(content, Landed):
        named_durably(content.path, target)
        return
    with written_whole(target) as file:
        file.write(content)
