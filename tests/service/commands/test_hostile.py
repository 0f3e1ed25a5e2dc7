"""Files made to do harm end no command: a line says why, and the exit code is that of unusable input."""

import resource
from pathlib import Path

import pytest

from benchmarks.files.hostile import HOSTILE
from tests.service.commands.conftest import Run

WORKBOOKS = {one.name: one for one in HOSTILE if one.name in ("xlsx-cells-without-r", "xlsx-row-of-a-million")}
"""One that claims far too much memory, and one that takes far too long where it is believed."""
MOST = 100 * 1024**2
"""Bytes that a command may grow by: those who read are processes of their own."""


@pytest.mark.parametrize("name", WORKBOOKS)
@pytest.mark.parametrize("command", ["calibrate", "diagnose"])
def test_a_hostile_workbook_is_unusable_input(run: Run, tmp_path: Path, command: str, name: str) -> None:
    file = tmp_path / "harm.xlsx"
    file.write_bytes(WORKBOOKS[name].make())
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    ran = run(command, file)
    assert (ran.code, ran.out, ran.err.count("\n")) == (2, "", 1)
    assert WORKBOOKS[name].says in ran.err
    assert (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) * 1024 < MOST
