"""Long files that were received whole and are still to be read, beside the uploads, each under a name of its own."""

from collections.abc import Sequence
from contextlib import suppress
from datetime import datetime, timedelta
from pathlib import Path

from service.errors import DamagedError
from service.kit.arriving_files import Content, Landed, Sent
from service.storage.faults import disk_faults
from service.storage.files import Files, file_hash
from service.storage.folders import is_name, make_folder, named_durably, named_in, sync_folder, written_whole

FOLDER = "waiting"
"""Beside the folders of the uploads, whose names are two hexadecimal digits."""
UNASKED = timedelta(hours=1)
"""That a file may wait before its job is on record: a commit takes a moment."""
GONE = "The received file was deleted or changed on the disk of the service. Nothing was stored: upload it again."


def put_waiting(files: Files, place: str, content: Content) -> None:
    """Keeps what was received, so that it survives a power cut."""
    target = _path(files, place)
    with disk_faults():
        make_folder(target.parent)
        if isinstance(content, Landed):
            named_durably(content.path, target)
        else:
            with written_whole(target) as file:
                file.write(content)
        sync_folder(target.parent)


def waiting_file(files: Files, sent: Sent) -> Landed:
    """The bytes as they were sent; DamagedError where they are gone."""
    return Landed(whole_file(files, sent.sha256, (sent.place,)), sent.sha256, sent.size)


def whole_file(files: Files, digest: str, places: Sequence[str]) -> Path:
    """Where bytes of this hash lie: in one of the places, or kept already, as by a try that was killed then."""
    for path in (*(_path(files, place) for place in places), files.path(digest)):
        with suppress(OSError):
            if file_hash(path) == digest:
                return path
    raise DamagedError(GONE)


def drop_waiting(files: Files, sent: Sent) -> None:
    """Removes what is left of it; nothing of ours lies under another kind of name."""
    if not is_name(sent.place):
        return
    with disk_faults():
        _path(files, sent.place).unlink(missing_ok=True)


def drop_unasked(files: Files, known: frozenset[str], now: datetime) -> None:
    """Removes what no job waits for: its service died before it could be asked for, or after it had ended."""
    with disk_faults():
        for path in (files.folder / FOLDER).glob("*"):
            if path.name not in known and path.stat().st_mtime < (now - UNASKED).timestamp():
                path.unlink(missing_ok=True)


def _path(files: Files, place: str) -> Path:
    return named_in(files.folder / FOLDER, place)
