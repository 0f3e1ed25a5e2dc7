"""Uploaded bytes, unchanged, under the name of their hash; safe on disk before the database knows of them."""

import os
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from tempfile import NamedTemporaryFile

from service.errors import NotFoundError
from service.storage.faults import disk_faults


def content_hash(content: bytes) -> str:
    """SHA-256, 64 hexadecimal digits."""
    return sha256(content).hexdigest()


@dataclass(frozen=True)
class Files:
    """A folder of uploads."""

    folder: Path

    def path(self, digest: str) -> Path:
        """Where the bytes of a hash are kept; made from the hash alone, never from an uploaded name."""
        return self.folder / digest[:2] / digest

    def keep(self, content: bytes) -> str:
        """Stores the bytes so that they survive a crash, and returns their hash; keeping them again changes nothing."""
        digest = content_hash(content)
        target = self.path(digest)
        with disk_faults():
            if not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                _write_whole(target, content)
        return digest

    def read(self, digest: str) -> bytes:
        """The bytes as they were uploaded."""
        try:
            return self.path(digest).read_bytes()
        except FileNotFoundError as missing:
            raise NotFoundError(f"The uploaded file {digest} is missing from {self.folder}.") from missing


def _write_whole(target: Path, content: bytes) -> None:
    """Under another name first: the file appears complete or not at all."""
    with NamedTemporaryFile(dir=target.parent, prefix=".part-", delete=False) as part:
        try:
            part.write(content)
            part.flush()
            os.fsync(part.fileno())
            Path(part.name).replace(target)
        except OSError:
            Path(part.name).unlink(missing_ok=True)
            raise
    _sync_folder(target.parent)
    _sync_folder(target.parent.parent)


def _sync_folder(folder: Path) -> None:
    """Makes the new name itself durable."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
