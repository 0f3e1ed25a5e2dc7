"""Where tests write: into memory where the machine has enough of it. Databases that come and go by the hundred wait for
the disk longer than their tests work."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

MEMORY = Path("/dev/shm")
ENOUGH = 6 * 2**30
"""Bytes free: more than three workers were seen to fill."""


def write_into_memory() -> None:
    """Puts the temporary files of this process, and of all that it starts, into memory until it ends."""
    if MEMORY.is_dir() and shutil.disk_usage(MEMORY).free >= ENOUGH:
        folder = tempfile.mkdtemp(prefix="imu-", dir=MEMORY)
        atexit.register(shutil.rmtree, folder, ignore_errors=True)
        os.environ["TMPDIR"] = tempfile.tempdir = folder
