"""``python -m benchmarks.study.amplitudes --sessions 600 --seed 1`` writes a section of docs/diagnosis/study.md.

A study of three hundred sessions tells the share of amplitudes within two sigma to four per cent, its target to two. So
amplitudes have a sample of their own: causes whose amplitude has one agreed meaning, one a session, in turn. A session
has up to three amplitudes, which are wrong together; the interval is that of sessions (ratio estimate, Cochran 1977).
"""

import argparse
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from statistics import fmean

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import in_full, publish, published
from benchmarks.study.examine import Task, run
from benchmarks.study.open_world import parts_of, with_command
from benchmarks.study.rates import Z, rate
from benchmarks.study.report import table
from tests.blind.catalogue import CATALOGUE
from tests.blind.score import UNCOMPARED, Outcome

PAGE = Path(__file__).parents[2] / "docs" / "diagnosis" / "study.md"
HEADING = "## Amplitudes on a sample of their own"
CAUSES = tuple(cause for cause in CATALOGUE if cause not in UNCOMPARED)


def tasks(sessions: int, seed: int) -> list[Task]:
    """The causes in turn."""
    return [Task("single", (seed, i), CAUSES[i % len(CAUSES)]) for i in range(sessions)]


def section(outcomes: list[Outcome]) -> str:
    """Markdown."""
    groups = {
        "all": outcomes,
        "strength 8 to 12": [o for o in outcomes if o.strengths[0] < 12],
        "12 to 27": [o for o in outcomes if 12 <= o.strengths[0] < 27],
        "above 27": [o for o in outcomes if o.strengths[0] >= 27],
        "separated by 5": [o for o in outcomes if o.separated],
        "nearer to a rival": [o for o in outcomes if not o.separated],
        "with a history": [o for o in outcomes if o.history],
        "without": [o for o in outcomes if not o.history],
        "noise not stated": [o for o in outcomes if o.unstated_noise],
    }
    head = ("sessions", "within two of their own sigma", "mean error, sigma", "root mean square")
    by_cause = {f"`{c}`": [o for o in outcomes if o.causes == (c,)] for c in CAUSES}
    return (
        f"{HEADING}\n\n{len(outcomes)} sessions, one effect each. The target is 93–97 %; intervals are those of "
        "sessions, since amplitudes of one are wrong together.\n\n"
        + table(head, [(name, *cells(own)) for name, own in groups.items() if pulls(own)])
        + "\n\n"
        + in_full(f"Of each cause some twenty amplitudes tell little (Wilson):\n\n{_by_cause(by_cause)}")
    )


def _by_cause(groups: Mapping[str, list[Outcome]]) -> str:
    return table(("cause", "within two sigma"), [(name, rate(inside(own))) for name, own in groups.items()])


def pulls(outcomes: Iterable[Outcome]) -> list[float]:
    """Errors in their own sigma."""
    return [p.value for o in outcomes for p in o.pulls]


def inside(outcomes: Iterable[Outcome]) -> list[bool]:
    """Whether each is within two."""
    return [abs(value) <= 2 for value in pulls(outcomes)]


def cells(outcomes: list[Outcome]) -> tuple[str, str, str]:
    """Share with its interval, mean, root mean square."""
    counted = [o for o in outcomes if o.pulls]
    number = np.array([len(o.pulls) for o in counted])
    hits = np.array([sum(abs(p.value) <= 2 for p in o.pulls) for o in counted])
    share = hits.sum() / number.sum()
    half = Z * np.sqrt(((hits - share * number) ** 2).sum()) / number.sum()
    low, high = max(0.0, share - half), min(1.0, share + half)
    values = pulls(counted)
    spread = fmean([v * v for v in values]) ** 0.5
    told = f"{100 * share:.1f} % ({100 * low:.1f}–{100 * high:.1f}) of {number.sum()} in {len(counted)}"
    return told, f"{fmean(values):+.2f}", f"{spread:.2f}"


def main() -> None:
    """Run it and write its section."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.amplitudes", description=__doc__)
    parser.add_argument("--sessions", type=int, default=600)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    outcomes = list(run(tasks(options.sessions, options.seed), options.processes))
    command = f"python -m benchmarks.study.amplitudes --sessions {options.sessions} --seed {options.seed}"
    write(with_command(section(outcomes), command))


def write(part: str, path: Path = PAGE) -> None:
    """The section at the end of the page, in place of an older one."""
    text = published(path)
    old = parts_of(text).get(HEADING)
    rest = text if old is None else text.replace(old, "")
    publish(rest.rstrip() + "\n\n" + part.rstrip() + "\n", path)


if __name__ == "__main__":
    main()
