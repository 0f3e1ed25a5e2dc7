"""A long raw log takes no more memory than the kernel lets its process have, which is less than its numbers take."""

from dataclasses import replace
from pathlib import Path

import pytest

from benchmarks.files.long import write_csv, write_parquet
from estimator.errors import FormatError
from service.ingest import limits, read_upload

ROWS = 4_000_000
"""Of 7 numbers: 224 MB of them."""
MEMORY = 176 * 1024**2
"""Bytes that the process may have beside the readers."""


@pytest.fixture
def little_memory():
    """For reading, until the test ends."""
    usual = limits.in_force()
    limits.use(replace(usual, memory=MEMORY))
    yield
    limits.use(usual)


@pytest.mark.parametrize("write", [write_csv, write_parquet])
def test_memory_does_not_grow_with_the_log(little_memory, tmp_path: Path, write) -> None:
    write(tmp_path / "log", ROWS)
    assert (tmp_path / "log").stat().st_size > MEMORY
    assert read_upload(tmp_path / "log", "log").readings.shape == (24, 6)


def test_the_same_log_read_whole_is_more_than_that_memory(little_memory, tmp_path: Path) -> None:
    write_parquet(tmp_path / "log", ROWS)
    limits.use(replace(limits.in_force(), cells=10**8, rows=10**7, whole=10**9))
    with pytest.raises(FormatError, match="MiB of memory"):
        read_upload(tmp_path / "log", "log")
