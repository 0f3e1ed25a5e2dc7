"""Prints the study and the recording: ``python -m benchmarks.hands --logs 60 > benchmarks/results/hands.md``."""

import sys
from argparse import ArgumentParser

from benchmarks.hands.recording import table
from benchmarks.hands.study import study


def main() -> None:
    """Print the page."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=int, default=100, help="simulated logs a row")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args()
    print(f"# Gyros by hand\n\nPrinted by `python -m benchmarks.hands --logs {given.logs}`.")
    print("\n## Simulated hands\n")
    print(
        "40 rests of 5 s and turns of 60 to 160° within 2 to 4 s, three accelerometers (10 mm/s² a sample) and gyros\n"
        "(2 mrad/s a sample), 100 Hz, rounded; wobble of up to 3 Hz, the Earth turns. The last row's rests are found\n"
        "rather than labelled; its bound is that of the labelled ones.\n"
    )
    print(study(given.logs, given.workers))
    print("\n## imu_tk's recording\n")
    try:
        print(table())
    except FileNotFoundError as absent:
        sys.exit(str(absent))


if __name__ == "__main__":
    main()
