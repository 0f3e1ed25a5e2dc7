"""``python -m benchmarks.study --sessions 2000 --seed 1`` writes docs/diagnosis/study.md.

What has been diagnosed is kept in build/study, and a study that was stopped goes on from there: remove the folder after
a change of the program.
"""

import argparse
import os
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.details import publish
from benchmarks.study.examine import tasks
from benchmarks.study.kept import BUILD, resumed
from benchmarks.study.report import page

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis" / "study.md"


def main() -> None:
    """Run the study and write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study", description=__doc__)
    parser.add_argument("--sessions", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=PAGE)
    parser.add_argument("--cause", help="only this cause, one effect a session")
    parser.add_argument("--kind", help="only this kind: single, weak, none, outside or two")
    parser.add_argument("--dump", help="folder for the files of every case that went wrong")
    options = parser.parse_args()
    work = tasks(options.sessions, options.seed, options.dump, options.kind, options.cause)
    command = f"python -m benchmarks.study --sessions {options.sessions} --seed {options.seed}"
    kept = BUILD / "study" / f"{options.seed}-{options.kind}-{options.cause}.jsonl"
    text = page(list(resumed(work, options.processes, kept)), command)
    publish(text, options.out)
    print(text)


if __name__ == "__main__":
    main()
