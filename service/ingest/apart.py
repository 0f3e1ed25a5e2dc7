"""Files read by a program of their own, with limits on time and memory: some libraries fall over on damaged ones."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

from service.ingest.limits import refusal

SECONDS = 30
"""After which the program is stopped: a whole file is read in a few."""


def read_apart(program: Path, content: bytes, filename: str, *arguments: str) -> tuple[dict[str, Any], bytes]:
    """The program's answer, a line of JSON, and what follows it; FormatError where it refuses, falls or takes long."""
    command = [sys.executable, "-I", str(program), *arguments]
    try:
        child = subprocess.run(command, input=content, capture_output=True, timeout=SECONDS, check=True)
    except subprocess.TimeoutExpired as error:
        raise refusal(filename, f"cannot be read within {SECONDS} s; it is damaged, write it again") from error
    except subprocess.CalledProcessError as error:
        raise refusal(filename, "is damaged and cannot be read; write it again") from error
    line, _, rest = child.stdout.partition(b"\n")
    answer: dict[str, Any] = json.loads(line)
    if "refused" in answer:
        field, message = answer["refused"]
        raise refusal(filename, message, field)
    return answer, rest
