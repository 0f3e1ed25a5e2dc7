"""Uploaded bytes are kept unchanged under their hash, whole or not at all, and are never given out changed."""

import errno
import fcntl
import os
from hashlib import sha256
from pathlib import Path

import pytest

from service.errors import AwayError, DamagedError, NoSpaceError, NotFoundError
from service.storage.faults import disk_faults
from service.storage.files import Files
from service.storage.folders import LOCK_DELAY


def half_written(files: Files, *, age: float) -> Path:
    """A part file as a process leaves it that dies while it writes."""
    part = files.path(files.keep(b"x")).with_name(".part-1")
    part.write_bytes(b"half")
    then = part.stat().st_mtime - age
    os.utime(part, (then, then))
    return part


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


def test_a_missing_file_is_not_found_counted_and_put_back_by_the_same_bytes(tmp_path: Path) -> None:
    told: list[str] = []
    files = Files(tmp_path, told.append)
    digest = files.keep(b"x")
    files.path(digest).unlink()
    with pytest.raises(NotFoundError, match="missing"):
        files.read(digest)
    files.put_back(b"x")
    assert files.read(digest) == b"x"
    assert told == ["missing", "put back"]


def test_a_changed_file_is_not_given_out_but_counted_and_put_back_by_the_same_bytes(tmp_path: Path) -> None:
    told: list[str] = []
    files = Files(tmp_path, told.append)
    digest = files.keep(b"x")
    files.path(digest).write_bytes(b"y")
    with pytest.raises(DamagedError, match="not what was uploaded"):
        files.read(digest)
    files.put_back(b"x")
    assert files.read(digest) == b"x"
    assert told == ["damaged", "put back"]


def test_putting_back_a_whole_file_is_not_told(tmp_path: Path) -> None:
    told: list[str] = []
    files = Files(tmp_path, told.append)
    files.keep(b"x")
    files.put_back(b"x")
    assert told == []


def test_what_dead_processes_left_is_swept(tmp_path: Path) -> None:
    files = Files(tmp_path)
    part = half_written(files, age=2 * LOCK_DELAY)
    assert (files.sweep(), part.exists(), files.read(sha256(b"x").hexdigest())) == (1, False, b"x")


def test_what_is_being_written_is_not_swept(tmp_path: Path) -> None:
    files = Files(tmp_path)
    half_written(files, age=0)
    assert files.sweep() == 0
    with half_written(files, age=2 * LOCK_DELAY).open("rb") as writer:
        fcntl.flock(writer, fcntl.LOCK_EX)
        assert files.sweep() == 0


def test_nothing_is_swept_where_nothing_was_kept(tmp_path: Path) -> None:
    assert Files(tmp_path / "none").sweep() == 0


def test_a_file_that_is_there_already_gets_its_name_synced_all_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    files = Files(tmp_path / "files")
    folder = files.path(files.keep(b"x")).parent
    synced, fsync = [], os.fsync

    def seen(handle: int) -> None:
        synced.append(Path(f"/proc/self/fd/{handle}").readlink())
        fsync(handle)

    monkeypatch.setattr(os, "fsync", seen)
    files.keep(b"x")
    assert synced == [folder, files.folder, tmp_path]


def test_a_full_disk_is_an_error_of_its_own() -> None:
    with Path("/dev/full").open("wb", buffering=0) as full, pytest.raises(NoSpaceError), disk_faults():
        full.write(b"x")


@pytest.mark.parametrize("refused", [errno.EROFS, errno.EACCES, errno.EIO])
def test_a_folder_that_cannot_be_written_is_away_in_words(refused: int) -> None:
    with pytest.raises(AwayError, match="folder of uploaded files cannot be written"), disk_faults():
        raise OSError(refused, os.strerror(refused))


def test_a_file_where_the_folder_should_be_is_said_in_words(tmp_path: Path) -> None:
    (tmp_path / "files").write_text("in the way")
    with pytest.raises(AwayError, match="nothing was stored"):
        Files(tmp_path / "files").keep(b"x")
