"""A large block that was freed is the system's again, also after a larger one was."""

import subprocess
import sys

import pytest

from service.ingest import apart

PROGRAM = """
import resource
from pathlib import Path
from service.ingest.memory import give_back_large_blocks
assert give_back_large_blocks()
def held():
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()
bytearray(30 * 2**20)
before = held()
blocks = [bytearray(10 * 2**20) for _ in range(10)]
last = bytearray(1000)
kept = blocks[-1]
del blocks
print((held() - before) // 2**20)
"""


# Elsewhere nothing is set, so that there is nothing to test: only glibc keeps what large blocks leave.
@pytest.mark.skipif(sys.platform != "linux", reason="mallopt, which this sets, is an option of glibc alone")
def test_large_blocks_are_given_back() -> None:
    command = [sys.executable, "-c", PROGRAM]
    run = subprocess.run(command, env={"PYTHONPATH": apart.ROOT}, capture_output=True, text=True)
    assert int(run.stdout) <= 11, run.stderr
