"""Long files that were received completely and wait to be read, next to the uploads, each under a name of its own."""

import os
from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime, timedelta
from pathlib import Path

from service.errors import DamagedError
from service.kit.arriving_files import Content, Landed
from service.storage.faults import disk_faults
from service.storage.files import Files
from service.storage.folders import is_name, make_folder, named_durably, named_in, sync_folder, written_whole
from service.storage.landing import file_hash

FOLDER = "waiting"
"""Next to the folders of the uploads, whose names are two hexadecimal digits."""
JOB_DELAY = timedelta(hours=1)
"""Longest time from a file's arrival to its job's commit, which takes a moment."""
MISSING = "The received file was deleted or changed on the disk of the service. Nothing was stored: upload it again."


def put_waiting(files: Files, place: str, content: Content) -> None:
    """Stores a received file durably."""
    target = _path(files, place)
    with disk_faults():
        make_folder(target.parent)
        if isinstance(content, Landed):
            named_durably(content.path, target)
        else:
            with written_whole(target) as file:
                file.write(content)
        sync_folder(target.parent)


def give_back(files: Files, place: str, content: Content) -> None:
    """Puts a file that is not to wait back where it was, or removes what was in memory."""
    if isinstance(content, Landed):
        with disk_faults():
            os.replace(_path(files, place), content.path)
    else:
        drop_waiting(files, place)


def waiting_file(files: Files, place: str, digest: str, size: int) -> Landed:
    """The bytes as they were sent; DamagedError where they are missing."""
    return Landed(whole_file(files, digest, (place,)), digest, size)


def whole_file(files: Files, digest: str, places: Sequence[str]) -> Path:
    """Path of the bytes of a hash: in one of the places, or stored already, as by an attempt that was killed then."""
    for path in (*(_path(files, place) for place in places), files.path(digest)):
        with suppress(OSError):
            if file_hash(path) == digest:
                return path
    raise DamagedError(MISSING)


def drop_waiting(files: Files, place: str) -> None:
    """Removes what is left of a waiting file; an invalid name is ignored."""
    if not is_name(place):
        return
    with disk_faults():
        _path(files, place).unlink(missing_ok=True)


def drop_orphaned(files: Files, known: frozenset[str], now: datetime) -> None:
    """Removes files without a job: its service died before the job was stored, or after it had ended."""
    with disk_faults():
        for path in (files.folder / FOLDER).glob("*"):
            if path.name not in known and path.stat().st_mtime < (now - JOB_DELAY).timestamp():
                path.unlink(missing_ok=True)


def _path(files: Files, place: str) -> Path:
    return named_in(files.folder / FOLDER, place)
