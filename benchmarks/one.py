"""One benchmark in a process of its own: ``python -m benchmarks.one p1_calibrate FILE`` adds every row to a file."""

import sys
from importlib import import_module
from pathlib import Path


def main() -> None:
    """A row is written as soon as it is measured."""
    name, file = sys.argv[1:]
    with Path(file).open("a", encoding="utf-8", buffering=1) as rows:
        for figure in import_module(f"benchmarks.{name}").run():
            rows.write(f"{figure.row()}\n")


if __name__ == "__main__":
    main()
