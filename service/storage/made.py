"""Files made by jobs, next to the uploads, each under the number of its job, until they expire."""

from pathlib import Path

from service.errors import NotFoundError
from service.storage.faults import disk_faults
from service.storage.files import Files, content_hash
from service.storage.folders import make_folder, named_in, sync_folder, written_whole

FOLDER = "made"
"""Next to the folders of the uploads, whose names are two hexadecimal digits."""


def put_made(files: Files, id: int, content: bytes) -> str:
    """Stores the file of a job durably, and returns its hash."""
    target = _path(files, id)
    with disk_faults():
        make_folder(target.parent)
        with written_whole(target) as file:
            file.write(content)
        sync_folder(target.parent)
    return content_hash(content)


def read_made(files: Files, id: int, digest: str) -> bytes:
    """The file of a job; NotFoundError where it is missing or was changed."""
    try:
        content = _path(files, id).read_bytes()
    except OSError:
        content = b""
    if content_hash(content) != digest:
        raise NotFoundError("The file of job {id} was deleted. Request it again.", id=id)
    return content


def drop_made(files: Files, id: int) -> None:
    """Removes it."""
    with disk_faults():
        _path(files, id).unlink(missing_ok=True)


def _path(files: Files, id: int) -> Path:
    return named_in(files.folder / FOLDER, str(id))
