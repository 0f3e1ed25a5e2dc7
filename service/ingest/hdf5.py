"""HDF5: group `readings` with one dataset a column; the metadata as JSON in the root's text attribute `imu-session`.

The file is opened by a program of its own (`hdf5_child`), with limits on time and memory.
"""

import json
import subprocess
import sys
from pathlib import Path

from service.ingest.limits import refusal
from service.ingest.metadata import KEY, with_metadata

MAGIC = b"\x89HDF\r\n\x1a\n"
"""First bytes (HDF5 file format, III.A)."""
CHILD = Path(__file__).with_name("hdf5_child.py")
"""Run by its path, so that it imports nothing of the service."""
MOST_CELLS = 5_000_000
"""Fewer than of other formats: they pass through a pipe as JSON."""
SECONDS = 30
"""After which the child is stopped: a whole file is read in a few."""


def read_hdf5(content: bytes, filename: str) -> dict[str, object]:
    """The document that an HDF5 file holds."""
    command = [sys.executable, "-I", str(CHILD), KEY, str(MOST_CELLS)]
    try:
        child = subprocess.run(command, input=content, capture_output=True, timeout=SECONDS, check=True)
    except subprocess.TimeoutExpired as error:
        raise refusal(filename, f"cannot be read within {SECONDS} s; it is damaged, write it again") from error
    except subprocess.CalledProcessError as error:
        raise refusal(filename, "is damaged or not a readable HDF5 file; write it again") from error
    answer = json.loads(child.stdout)
    if "refused" in answer:
        field, message = answer["refused"]
        raise refusal(filename, message, field)
    return with_metadata(answer["metadata"], answer["columns"], filename)
