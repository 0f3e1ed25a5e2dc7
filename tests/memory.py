"""Folder that tests write to: in memory where the machine has enough of it. Databases that come and go by the hundred
wait for the disk longer than their tests work.
"""

import os
import shutil
import tempfile
from multiprocessing.util import Finalize
from pathlib import Path

MEMORY = Path("/dev/shm")
LAST = -1000
"""Processes that share memory remove their own folder a little earlier."""
ENOUGH = 6 * 2**30
"""Bytes free. A third of the service's tests, in one process, filled half a GiB; there are eight workers at most."""


def write_into_memory() -> None:
    """Puts the temporary files of this process, and of all that it starts, into memory until it ends."""
    if MEMORY.is_dir() and shutil.disk_usage(MEMORY).free >= ENOUGH:
        folder = tempfile.mkdtemp(prefix="imu-", dir=MEMORY)
        Finalize(None, shutil.rmtree, (folder,), {"ignore_errors": True}, exitpriority=LAST)
        os.environ["TMPDIR"] = tempfile.tempdir = folder
