"""``python -m benchmarks.backtest.watching --seed 9`` writes benchmarks/results/health/watching.md.

A parameter is looked at after every session, as a workshop does, by our detection and by the control charts that are
used instead. Every rule has the threshold at which sound histories raise one alarm in a hundred years; then it is asked
how often it finds a change by the end of its history, and how many sessions after the first that could show it.

Page's sum (CUSUM) and Wald's sequential ratio (SPRT) take the deviations from the reference, or, self-starting (Hawkins
1987), what a session departs from the weighted mean of those before it. A generalised likelihood ratio (Willsky & Jones
1976) tries a step at every session. The newest session alone is what a test of one session's parity residuals sees.
"""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np

from benchmarks.backtest.detection import p_value
from benchmarks.backtest.histories import STEP, History
from benchmarks.backtest.rivals import SLACK
from benchmarks.backtest.worlds import FIRST
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.session import Array

PAGE = Path(__file__).parents[1] / "results" / "health" / "watching.md"
ALARMS = 0.01
"""A sound history-year."""
SHIFT = 1.0
"""Standard errors that Wald's ratio is made for."""
GIVEN_UP = -2.3
"""ln 0.1: where Wald's test accepts that nothing moved, with a tenth of misses, and begins anew."""
LEAST = 1e-300
SIZES = {"step": (0.4, 0.6, 0.9, 1.2), "late ramp": (0.2, 0.4, 0.6, 0.8)}
"""T, and T a year: limits of the groups."""
UNITS = {"step": "T", "late ramp": "T a year"}

Watch = Callable[[History], Array]
"""(n,) figures after every session, the first of them the reference; each grows with suspicion."""


def ours(history: History) -> Array:
    """−ln p of the estimator's detection, from the third session on."""
    n = len(history.time)
    found = [-np.log(max(p_value(first(history, k)), LEAST)) for k in range(3, n + 1)]
    return np.array([0.0, 0.0, *found])


def first(history: History, k: int) -> History:
    """The first k sessions of the history."""
    parts = (history.time[:k], history.value[:k], history.sigma[:k], history.temperature[:k])
    return History(history.kind, history.truth, history.onset, *parts)


def from_reference(history: History) -> Array:
    """(n,) deviations from the reference in standard errors, its own counted."""
    return np.asarray(history.value / np.hypot(history.sigma, history.sigma[0]))


def from_mean(history: History) -> Array:
    """(n,) departures from the weighted mean of the sessions before, in standard errors; 0 of the reference."""
    weight = history.sigma**-2.0
    sums = np.cumsum(weight)
    mean = np.cumsum(weight * history.value) / sums
    departure = (history.value[1:] - mean[:-1]) / np.sqrt(history.sigma[1:] ** 2 + 1 / sums[:-1])
    return np.concatenate([[0.0], departure])


def summed(x: Array) -> Array:
    """(n,) the larger of Page's sums, up and down."""
    up = down = 0.0
    found = []
    for one in x:
        up, down = max(0.0, up + one - SLACK), max(0.0, down - one - SLACK)
        found.append(max(up, down))
    return np.array(found)


def wald(x: Array) -> Array:
    """(n,) the larger of Wald's log ratios, up and down, each begun anew where nothing is accepted."""
    ratios, found = np.zeros(2), []
    for one in x:
        ratios += SHIFT * (np.array([one, -one]) - SHIFT / 2)
        ratios[ratios < GIVEN_UP] = 0.0
        found.append(ratios.max())
    return np.array(found)


def one_step(history: History) -> Array:
    """(n,) largest χ² of a step at any session so far, level unknown, noise known."""
    weight = history.sigma**-2.0
    before, moment = np.cumsum(weight), np.cumsum(weight * history.value)
    found = [0.0]
    for k in range(1, len(weight)):
        early, late = before[:k], before[k] - before[:k]
        change = (moment[k] - moment[:k]) / late - moment[:k] / early
        found.append(float((change**2 / (1 / early + 1 / late)).max()))
    return np.array(found)


RULES: dict[str, Watch] = {
    "likelihood of all changes (ours)": ours,
    "CUSUM from the reference": lambda one: summed(from_reference(one)),
    "CUSUM, self-starting": lambda one: summed(from_mean(one)),
    "SPRT, self-starting": lambda one: wald(from_mean(one)),
    "GLR of one step": one_step,
    "newest session alone": lambda one: np.abs(from_reference(one)),
}


def threshold(figures: Sequence[Array], sound: Sequence[History]) -> float:
    """The threshold at which sound histories raise `ALARMS` a year, each watched until its first."""
    levels = np.unique(np.concatenate([np.maximum.accumulate(one) for one in figures]))
    low, high = 0, len(levels) - 1
    while low < high:
        middle = (low + high) // 2
        alarms = [alarm(one, levels[middle]) for one in figures]
        years = sum(h.time[-1 if a is None else a] for a, h in zip(alarms, sound, strict=True))
        too_many = sum(a is not None for a in alarms) > ALARMS * years
        low, high = (middle + 1, high) if too_many else (low, middle)
    return float(levels[low])


def alarm(figures: Array, level: float) -> int | None:
    """Number of the session at which a rule raises its first alarm."""
    beyond = np.flatnonzero(figures > level)
    return int(beyond[0]) if len(beyond) else None


def size(history: History) -> float:
    """T of a step, T a year of a ramp."""
    moved = np.abs(np.diff(history.truth))
    return float(moved.max() if history.kind == "step" else moved.max() / STEP)


def delays(figures: Sequence[Array], histories: Sequence[History], level: float) -> list[int | None]:
    """Sessions to the alarm, the first that could show the change being 1; None where it comes never or before."""
    found: list[int | None] = []
    for own, history in zip(figures, histories, strict=True):
        first_to_show, at = int(np.searchsorted(history.time, history.onset, side="right")), alarm(own, level)
        found.append(None if at is None or at < first_to_show else at - first_to_show + 1)
    return found


def cell(found: Sequence[int | None]) -> str:
    """Share found, and the middle delay of all with its 95 % interval by order statistics; – where half are not."""
    late = np.sort([np.inf if one is None else one for one in found])
    n = len(late)
    spread = 1.96 * np.sqrt(n) / 2
    places = np.clip(np.round([n / 2, n / 2 - spread, n / 2 + spread]).astype(int), 0, n - 1)
    middle, low, high = ("never" if np.isinf(one) else f"{one:.0f}" for one in late[places])
    return f"{rate([one is not None for one in found])}; {middle} ({low}–{high})"


def page(sound_count: int, count: int, seed: int) -> str:
    """Markdown."""
    rng = np.random.default_rng([seed, 3])
    plan = FIRST.planned((8, 16), since=3)
    sound = [FIRST.made(FIRST.still, plan, rng) for _ in range(sound_count)]
    events = {kind: [FIRST.made(kind, plan, rng) for _ in range(count)] for kind in SIZES}
    levels = {name: threshold([watch(one) for one in sound], sound) for name, watch in RULES.items()}
    parts = [heading(sound, count, seed)]
    for kind, histories in events.items():
        groups = np.digitize([size(one) for one in histories], SIZES[kind][1:-1])
        heads = [f"{low:g} to {high:g} {UNITS[kind]}" for low, high in zip(SIZES[kind], SIZES[kind][1:], strict=False)]
        rows = []
        for name, watch in RULES.items():
            late = delays([watch(one) for one in histories], histories, levels[name])
            own = [[one for one, group in zip(late, groups, strict=True) if group == k] for k in range(len(heads))]
            rows.append((name, *(cell(one) if one else "–" for one in own)))
        parts.append(f"## {kind.capitalize()}\n\n" + table(("rule", *heads), rows))
    return "\n\n".join(parts) + "\n"


def heading(sound: Sequence[History], count: int, seed: int) -> str:
    """The heading of the page, with the histories that were watched."""
    years = sum(one.time[-1] for one in sound)
    return (
        "# Detection, session by session\n\n"
        f"Made by `python -m benchmarks.backtest.watching --seed {seed} --sound {len(sound)} --histories {count}`: "
        f"{len(sound)} sound histories of {years:.0f} years together set every rule's threshold to one alarm in "
        f"{1 / ALARMS:.0f} years; {count} histories with each change. Share found by the end of the history, in % with "
        "its 95 % interval; then the sessions to the alarm, the first that could show the change counted as 1: median "
        "of all histories, with its 95 % interval."
    )


def main() -> None:
    """The page, from a fixed seed."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seed", type=int, default=9)
    asked.add_argument("--sound", type=int, default=400)
    asked.add_argument("--histories", type=int, default=150)
    asked.add_argument("--out", type=Path, default=PAGE)
    given = asked.parse_args()
    given.out.write_text(page(given.sound, given.histories, given.seed), encoding="utf-8")


if __name__ == "__main__":
    main()
