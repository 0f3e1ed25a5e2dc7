"""Uploaded bytes are kept unchanged under their hash, whole or not at all."""

from hashlib import sha256
from pathlib import Path

import pytest

from service.errors import NoSpaceError, NotFoundError
from service.storage.faults import disk_faults
from service.storage.files import Files


def test_bytes_come_back_unchanged_from_under_their_hash(tmp_path: Path) -> None:
    files, content = Files(tmp_path / "files"), bytes(range(256))
    digest = files.keep(content)
    assert digest == sha256(content).hexdigest()
    assert files.read(digest) == content


def test_keeping_again_changes_nothing(tmp_path: Path) -> None:
    files = Files(tmp_path)
    before = files.path(files.keep(b"x")).stat()
    assert files.path(files.keep(b"x")).stat().st_ino == before.st_ino


def test_only_whole_files_have_names(tmp_path: Path) -> None:
    Files(tmp_path).keep(b"x")
    names = [path.name for path in tmp_path.rglob("*") if path.is_file()]
    assert names == [sha256(b"x").hexdigest()]


def test_a_missing_file_is_not_found(tmp_path: Path) -> None:
    with pytest.raises(NotFoundError, match="missing"):
        Files(tmp_path).read("0" * 64)


def test_a_full_disk_is_an_error_of_its_own() -> None:
    with Path("/dev/full").open("wb", buffering=0) as full, pytest.raises(NoSpaceError), disk_faults():
        full.write(b"x")
