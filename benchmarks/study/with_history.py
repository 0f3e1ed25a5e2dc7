"""``python -m benchmarks.study.with_history --groups 40 --seed 1``: what earlier sessions add to a diagnosis.

Units of twelve sessions with an effect that none of them shows by itself (pooled strength 8 to 9.5, at most 3.5 in a
session), as `tests.blind.groups` draws them: the twelfth is diagnosed with the other eleven as history, once with the
effect in it and once without; and units without any effect.
"""

import argparse
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.study.rates import rate
from estimator import Diagnosis, diagnose, read_session
from tests.blind.groups import Group, draw_group
from tests.blind.physics import measure
from tests.blind.write import session_file

SESSIONS = 12


@dataclass(frozen=True)
class Told:
    """One unit."""

    alone: bool
    """Whether the twelfth session names it without a history."""
    named: bool
    """Whether the twelfth session names it, or lists it, with a history."""
    strength: float
    """Strength in the twelfth session, standard errors."""
    ended: bool
    """Whether the twelfth session names it as lasting once it has ended."""
    sound: bool
    """Whether the twelfth session of a unit without an effect names anything that only several sessions show."""
    by_itself: bool
    """Whether that session names anything else."""


def perform(seed: tuple[int, ...]) -> Told:
    """One unit with an effect, and one without."""
    group = draw_group("unit", "one", (*seed, 1), size=SESSIONS, quiet=True)
    sound = draw_group("unit", "none", (*seed, 2), size=SESSIONS)
    (truth,) = group.truths
    sessions = [read_session(f) for f in group.sessions]
    last = group.worlds[-1]
    without = read_session(session_file(last, measure(last, [], np.random.default_rng(seed))[0]))
    ended = diagnose(without, sessions[:-1])
    nothing = of_last(sound)
    return Told(
        alone=names(diagnose(sessions[-1]), truth.effect.cause, truth.names),
        named=names(diagnose(sessions[-1], sessions[:-1]), truth.effect.cause, truth.names),
        strength=truth.strengths[-1],
        ended=any(f.over_sessions is not None for f in ended.findings),
        sound=any(f.over_sessions is not None for f in nothing.findings),
        by_itself=any(f.over_sessions is None for f in nothing.findings),
    )


def of_last(group: Group) -> Diagnosis:
    """The last session with all others as history."""
    sessions = [read_session(f) for f in group.sessions]
    return diagnose(sessions[-1], sessions[:-1])


def names(found: Diagnosis, cause: str, sensors: Sequence[str]) -> bool:
    """Whether a cause is named at its place, or listed."""
    return any(cause in (f.cause, *f.alternatives) and set(sensors) <= set(f.sensors) for f in found.findings)


def table(told: Sequence[Told]) -> Iterator[str]:
    """Rows: figure, measured."""
    seen = [t for t in told if t.strength >= 2]
    rows = {
        "the twelfth by itself: named or listed": [t.alone for t in told],
        "with eleven earlier ones: named or listed": [t.named for t in told],
        "the same, where its own strength is 2 or more": [t.named for t in seen],
        "ended before the twelfth: named all the same": [t.ended for t in told],
        "the same, where its strength would have been 2 or more": [t.ended for t in seen],
        "no effect: anything named that only several sessions show": [t.sound for t in told],
        "no effect: anything else named": [t.by_itself for t in told],
    }
    for words, marks in rows.items():
        yield f"| {words} | {rate(marks)} |"


def main() -> None:
    """Run and print the table."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.with_history", description=__doc__)
    parser.add_argument("--groups", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    told = []
    for k in range(options.groups):
        told.append(perform((options.seed, k)))
        print(k + 1, *table(told), sep="\n", flush=True)


if __name__ == "__main__":
    main()
