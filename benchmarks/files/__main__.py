"""``python -m benchmarks.files`` writes docs/security/files.md: what every hostile and every heaviest file costs."""

import argparse
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.details import publish
from benchmarks.files.heavy import as_parquet, heaviest
from benchmarks.files.hostile import HOSTILE
from benchmarks.files.long import ROWS, long_logs
from benchmarks.files.ordinary import milliseconds
from benchmarks.files.page import Row, page
from benchmarks.files.service import Service, service

PAGE = Path(__file__).parents[2] / "docs" / "security" / "files.md"


def main() -> None:
    """Measure and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.files", description=__doc__)
    parser.add_argument("--out", type=Path, default=PAGE)
    parser.add_argument("--only", default="", help="only files whose name holds this")
    parser.add_argument("--rows", type=int, default=ROWS, help="of the long logs")
    options = parser.parse_args()
    with TemporaryDirectory() as folder, service(Path(folder), as_parquet("U-first")) as running:
        rows = list(_measured(running, options.only))
    with TemporaryDirectory() as folder:
        long = list(long_logs(Path(folder), options.rows))
    text = page(rows, milliseconds(), long)
    publish(text, options.out)
    print(text)


def _measured(running: Service, only: str) -> Iterator[Row]:
    files: list[tuple[str, Callable[[], list[bytes]]]] = [("nothing, for scale", list)]
    files += [(one.name, _alone(one.make)) for one in HOSTILE]
    for name, make in (*files, *heaviest()):
        if only in name:
            contents = make()
            row = Row(name, len(contents[0]) if contents else 0, running.cost(contents))
            print(row, file=sys.stderr)
            yield row


def _alone(make: Callable[[], bytes]) -> Callable[[], list[bytes]]:
    return lambda: [make()]


if __name__ == "__main__":
    main()
