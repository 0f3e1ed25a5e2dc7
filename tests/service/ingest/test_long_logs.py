"""A long raw log takes no more memory than the kernel lets its process have, which is less than its numbers take."""

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.files.long import write_csv, write_parquet
from estimator.errors import FormatError
from service.ingest import read_upload
from service.kit import limits

MEBIBYTE = 1024**2


@pytest.fixture
def memory():
    """Sets what reading may take, until the test ends."""
    usual = limits.in_force()
    yield lambda mebibytes: limits.use(replace(usual, memory=mebibytes * MEBIBYTE))
    limits.use(usual)


@pytest.mark.slow
@pytest.mark.parametrize(("write", "rows", "most"), [(write_csv, 1_600_000, 96), (write_parquet, 3_000_000, 128)])
def test_memory_does_not_grow_with_the_log(memory, tmp_path: Path, write, rows: int, most: int) -> None:
    memory(most)
    write(tmp_path / "log", rows)
    assert (tmp_path / "log").stat().st_size > most * MEBIBYTE
    assert read_upload(tmp_path / "log", "log").readings.shape == (24, 6)


@pytest.mark.slow
def test_the_same_log_read_whole_is_more_than_that_memory(memory, tmp_path: Path) -> None:
    memory(128)
    write_parquet(tmp_path / "log", 3_000_000)
    limits.use(replace(limits.in_force(), cells=10**8, rows=10**7, whole=10**9))
    with pytest.raises(FormatError, match="MiB of memory"):
        read_upload(tmp_path / "log", "log")
