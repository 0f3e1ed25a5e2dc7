"""Large tables of custom layout, stored temporarily until their mapping is confirmed: under the hash of their owner and
their content, for a limited time and in limited number."""

import os
from datetime import datetime, timedelta
from hashlib import sha256
from pathlib import Path

from service.kit.arriving_files import Content, Landed
from service.storage.faults import disk_faults
from service.storage.files import Files, content_hash
from service.storage.folders import make_folder, named_in, written_whole

FOLDER = "aside"
"""Next to the folders of the uploads, whose names are two hexadecimal digits."""
RETENTION = timedelta(hours=12)
"""Time since the last access: a mapping is finished on the same day."""
MOST = 10
"""Most tables of one account: a new one replaces the oldest."""
MOST_BYTES = 1024**3
"""Most bytes of all accounts, beside the newest table."""
OWNER_DIGITS = 16
"""Digits of the hash of a login, which may hold any character."""


def set_aside(files: Files, owner: str, content: Content, now: datetime) -> str:
    """Stores a table for an account, and returns the hash under which it is found again."""
    digest = content_hash(content)
    target = _path(files, owner, digest)
    with disk_faults():
        make_folder(target.parent)
        if isinstance(content, Landed):
            os.replace(content.path, target)
        else:
            with written_whole(target) as file:
                file.write(content)
        _touch(target, now)
    _make_room(files, owner, now)
    return digest


def aside(files: Files, owner: str, digest: str, now: datetime) -> Landed | None:
    """A table of an account; None where it has expired or was replaced by others."""
    path = _path(files, owner, digest)
    if path not in _fresh(files, now):
        return None
    with disk_faults():
        _touch(path, now)
        return Landed(path, digest, path.stat().st_size)


def drop_aside(files: Files, owner: str, digest: str) -> None:
    """Removes a table that is stored or no longer wanted."""
    with disk_faults():
        _path(files, owner, digest).unlink(missing_ok=True)


def drop_stale(files: Files, now: datetime) -> None:
    """Removes expired tables."""
    fresh = _fresh(files, now)
    with disk_faults():
        for path in _all(files):
            if path not in fresh:
                path.unlink(missing_ok=True)


def _make_room(files: Files, owner: str, now: datetime) -> None:
    """Removes the oldest beyond the number of the owner and the bytes of all."""
    drop_stale(files, now)
    count, size = 0, 0
    with disk_faults():
        for place, path in enumerate(sorted(_all(files), key=_age, reverse=True)):
            count += path.name.startswith(_prefix(owner))
            size += _access(path)[1] if place else 0
            if size > MOST_BYTES or (count > MOST and path.name.startswith(_prefix(owner))):
                path.unlink(missing_ok=True)


def _all(files: Files) -> list[Path]:
    return [path for path in (files.folder / FOLDER).glob("*") if not path.name.startswith(".")]


def _fresh(files: Files, now: datetime) -> set[Path]:
    return {path for path in _all(files) if _age(path) > (now - RETENTION).timestamp()}


def _age(path: Path) -> float:
    return _access(path)[0]


def _access(path: Path) -> tuple[float, int]:
    try:
        status = path.stat()
    except FileNotFoundError:
        return 0.0, 0
    return status.st_mtime, status.st_size


def _touch(path: Path, now: datetime) -> None:
    os.utime(path, (now.timestamp(), now.timestamp()))


def _prefix(owner: str) -> str:
    return f"{sha256(owner.encode()).hexdigest()[:OWNER_DIGITS]}-"


def _path(files: Files, owner: str, digest: str) -> Path:
    """Made from hashes alone, whatever a form sends."""
    return named_in(files.folder / FOLDER, f"{_prefix(owner)}{sha256(digest.encode()).hexdigest()}")
