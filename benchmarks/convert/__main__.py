"""`python -m benchmarks.convert FORMAT FILE...`: recordings of public data sets to session files."""

import argparse
import json
import sys
from pathlib import Path

from benchmarks.convert import FORMATS, convert
from estimator.errors import SessionError

UNUSABLE = 2
"""Exit code for files that cannot be used, as of `imu-health`."""


def main() -> int:
    """Writes the session files and prints where they are."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.convert", description=__doc__)
    parser.add_argument("format", metavar="FORMAT", choices=[one.name for one in FORMATS])
    parser.add_argument("files", metavar="FILE", nargs="+", type=Path, help="the recording")
    parser.add_argument("--out", type=Path, default=Path(), help="folder to write the session files to")
    asked = parser.parse_args()
    try:
        sessions = convert(asked.format, asked.files)
    except SessionError as fault:
        print(fault, file=sys.stderr)
        return UNUSABLE
    asked.out.mkdir(parents=True, exist_ok=True)
    for name, document in sessions:
        target = asked.out / name
        target.write_text(json.dumps(document, allow_nan=False), encoding="utf-8")
        print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main())
