"""Folders whose names survive a power cut, and the names that may stand in them."""

import os
import re
from pathlib import Path

from estimator.message import say
from service.errors import DamagedError

NAME = re.compile(r"[0-9a-z][0-9a-z-]{0,99}")
"""Hashes, numbers and identifiers: nothing that leads out of a folder."""


def is_name(name: object) -> bool:
    """Whether a stored file may be called so."""
    return isinstance(name, str) and NAME.fullmatch(name) is not None


def named_in(folder: Path, name: str) -> Path:
    """Where a file of this name lies; every name that is stored becomes a path here, and nowhere else."""
    if not is_name(name):
        raise DamagedError(
            say("{name} is not the name of a stored file: the record that names it was changed.", name=repr(name[:100]))
        )
    return folder / name


def sync_folder(folder: Path) -> None:
    """Makes the names in a folder durable."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def make_folder(folder: Path) -> None:
    """Makes a folder and those above it that are missing, each durably."""
    if not folder.is_dir():
        make_folder(folder.parent)
        folder.mkdir(exist_ok=True)
        sync_folder(folder.parent)
