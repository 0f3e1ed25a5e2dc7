"""Files that jobs made, beside the uploads, each under the number of its job, until its time is over."""

from pathlib import Path

from estimator.message import say
from service.errors import NotFoundError
from service.storage.faults import disk_faults
from service.storage.files import Files, content_hash
from service.storage.folders import make_folder, named_in, sync_folder, written_whole

FOLDER = "made"
"""Beside the folders of the uploads, whose names are two hexadecimal digits."""


def put_made(files: Files, id: int, content: bytes) -> str:
    """Keeps what a job made, so that it survives a power cut, and returns its hash."""
    target = _path(files, id)
    with disk_faults():
        make_folder(target.parent)
        with written_whole(target) as file:
            file.write(content)
        sync_folder(target.parent)
    return content_hash(content)


def read_made(files: Files, id: int, digest: str) -> bytes:
    """What a job made; NotFoundError where it is gone or was changed."""
    try:
        content = _path(files, id).read_bytes()
    except OSError:
        content = b""
    if content_hash(content) != digest:
        raise NotFoundError(say("The file of job {id} was deleted. Request it again.", id=id))
    return content


def drop_made(files: Files, id: int) -> None:
    """Removes it."""
    with disk_faults():
        _path(files, id).unlink(missing_ok=True)


def _path(files: Files, id: int) -> Path:
    return named_in(files.folder / FOLDER, str(id))
