"""Reads a backup from end to end, and says whether it is what was written."""

import zipfile
from collections.abc import Iterator
from hashlib import sha256
from pathlib import Path

from service.errors import DamagedError
from service.storage.backup.manifest import UNREADABLE, Manifest, TableContents, file_member, opened, read_manifest
from service.storage.backup.names import faulty_names


def verified(file: Path) -> Manifest:
    """What a backup holds; DamagedError with every part that is not as it was written."""
    with opened(file) as archive:
        manifest = read_manifest(archive)
        faults = list(_faults(archive, manifest))
    if faults:
        raise DamagedError(f"{file} is damaged: {'; '.join(faults)}.")
    return manifest


def _faults(archive: zipfile.ZipFile, manifest: Manifest) -> Iterator[str]:
    """Whatever is not as the manifest says."""
    yield from (f"{name} does not belong to it" for name in sorted(set(archive.namelist()) - manifest.members))
    for table in manifest.tables:
        if not _is_table(archive, table):
            yield f"table {table.name} was changed or is missing"
        else:
            yield from faulty_names(archive, table)
    for digest in manifest.files:
        if not _is_file(archive, digest):
            yield f"file {digest} was changed or is missing"


PIECE = 1024 * 1024
"""Bytes of a file that are held at a time."""


def _is_table(archive: zipfile.ZipFile, table: TableContents) -> bool:
    hashed, rows = sha256(), 0
    try:
        with archive.open(table.member) as lines:
            for line in lines:
                hashed.update(line)
                rows += 1
    except UNREADABLE:
        return False
    return (hashed.hexdigest(), rows) == (table.sha256, table.rows)


def _is_file(archive: zipfile.ZipFile, digest: str) -> bool:
    try:
        with archive.open(file_member(digest)) as member:
            hashed = sha256()
            while piece := member.read(PIECE):
                hashed.update(piece)
            return hashed.hexdigest() == digest
    except UNREADABLE:
        return False
