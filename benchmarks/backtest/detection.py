"""How soon a drift is noticed, beside the rules that are used instead, on the same histories.

Every rule looks at the sessions as they come and gives each a figure that grows with suspicion; it raises an alarm when
the figure passes its threshold. Thresholds are set so that 5 % of histories without a drift ever raise one: of stable
ones, and of stable and wandering ones together. Rules with a threshold of their own are shown with it too.
"""

from collections.abc import Callable, Sequence

import numpy as np
import ruptures

from benchmarks.backtest.histories import History, histories
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.health.trend import sudden, trends
from estimator.session import Array

LEVEL = 0.05
SIGMA = 0.1
LAMBDA = 0.3
SLACK = 0.5
FIXED = 0.05
OWN = 0.01
"""p-value below which a drift or a step counts as found."""
Rule = Callable[[Sequence[History]], Array]


def ours(made: Sequence[History]) -> Array:
    """−ln of the smaller p-value, of the rate or of a step; (B, n), −∞ before the third session."""
    figure = np.full((len(made), _longest(made)), -np.inf)
    for k in range(3, figure.shape[1] + 1):
        rows = [i for i, h in enumerate(made) if len(h.series.time) >= k]
        seen = [made[i].first(k) for i in rows]
        p = np.minimum(trends(seen).p_value, sudden(seen) if k > 3 else 1.0)
        figure[rows, k - 1] = -np.log(np.maximum(p, 1e-300))
    return figure


def fixed(made: Sequence[History]) -> Array:
    """|change since the reference|, in tolerances."""
    return _each(made, np.abs)


def ewma(made: Sequence[History]) -> Array:
    """|exponentially weighted mean| of the changes in sigmas."""

    def follow(change: Array) -> Array:
        mean, found = 0.0, []
        for x in change / SIGMA:
            mean = (1 - LAMBDA) * mean + LAMBDA * x
            found.append(abs(mean))
        return np.array(found)

    return _each(made, follow)


def cusum(made: Sequence[History]) -> Array:
    """Larger of the two cumulative sums of the changes in sigmas, less the slack."""

    def follow(change: Array) -> Array:
        up = down = 0.0
        found = []
        for x in change / SIGMA:
            up, down = max(0.0, up + x - SLACK), max(0.0, down - x - SLACK)
            found.append(max(up, down))
        return np.array(found)

    return _each(made, follow)


def change_point(made: Sequence[History]) -> Array:
    """What one change of the mean, placed by `ruptures` (dynamic programming, squared error), takes off the cost."""

    def follow(change: Array) -> Array:
        return np.array([0.0, *(_saved(change[:k]) for k in range(2, len(change) + 1))])

    return _each(made, follow)


def _saved(change: Array) -> float:
    search = ruptures.Dynp(model="l2", min_size=1, jump=1).fit(change[:, None] / SIGMA)
    place = search.predict(n_bkps=1)[0]
    return float(
        search.cost.error(0, len(change)) - sum(search.cost.error(*ends) for ends in ((0, place), (place, len(change))))
    )


def _each(made: Sequence[History], follow: Callable[[Array], Array]) -> Array:
    figure = np.full((len(made), _longest(made)), -np.inf)
    for row, history in zip(figure, made, strict=True):
        row[: len(history.series.time)] = follow(history.series.value)
    return figure


def _longest(made: Sequence[History]) -> int:
    return max(len(h.series.time) for h in made)


RULES: dict[str, Rule] = {
    "ours": ours,
    "fixed share of the tolerance": fixed,
    "EWMA, λ = 0.3": ewma,
    "CUSUM, slack 0.5 σ": cusum,
    "one change of the mean, ruptures": change_point,
}
EVENTS = ("step", "ramp")


def detection_page(count: int, seed: int) -> str:
    """Markdown."""
    rng = np.random.default_rng(seed)
    stable = histories("stable", count, rng, sigma=SIGMA)
    walking = histories("walk", count // 2, rng, sigma=SIGMA)
    swinging = histories("temperature", count // 2, rng, sigma=SIGMA)
    events = {kind: histories(kind, count // 2, rng, late=True, sigma=SIGMA) for kind in EVENTS}
    rows = []
    for name, rule in RULES.items():
        quiet, moved = rule(stable), {kind: rule(made) for kind, made in events.items()}
        others = [rule(walking), rule(swinging)]
        without = np.concatenate([quiet[: len(walking)].max(axis=1), others[0].max(axis=1)])
        thresholds = {
            "tuned on stable": float(np.quantile(quiet.max(axis=1), 1 - LEVEL)),
            "tuned on stable and wandering": float(np.quantile(without, 1 - LEVEL)),
        }
        if name in OWN_THRESHOLDS:
            thresholds["as it is"] = OWN_THRESHOLDS[name]
        for how, threshold in thresholds.items():
            alarms = [str(rate(list(map(bool, f.max(axis=1) > threshold)))) for f in (quiet, *others)]
            found = [_found(events[kind], moved[kind], threshold) for kind in EVENTS]
            rows.append((f"{name}, {how}", *alarms, *(cell for pair in found for cell in pair)))
    head = (
        "rule", "alarms: stable", "walk", "temperature", "step found", "median delay, sessions",
        "ramp found", "median delay, sessions",
    )  # fmt: skip
    return (
        "## How soon is a drift noticed?\n\n"
        f"Sessions with σ = {SIGMA} T; steps and ramps begin after half a year to two years. Tuned: "
        f"{100 * LEVEL:.0f} % of the histories without a drift ever raise an alarm: of the stable ones, or of as many "
        "stable as wandering ones; the same histories for every rule. As it is: ours at p < "
        f"{OWN}, the fixed rule at a change of {100 * FIXED:.0f} % of the tolerance. A delay of 1 is the first session "
        "after the event; – where less than half are found. A random walk is no drift and has no step.\n\n"
        + table(head, rows)
    )


OWN_THRESHOLDS = {"ours": -np.log(OWN), "fixed share of the tolerance": FIXED}


def _found(made: Sequence[History], figure: Array, threshold: float) -> tuple[str, str]:
    """Share of events that are noticed after they began, and the sessions that it took."""
    delays = []
    for history, row in zip(made, figure, strict=True):
        before = int((history.series.time < history.onset).sum())
        alarms = np.flatnonzero(row[before:] > threshold)
        delays.append(float(alarms[0] + 1) if alarms.size else np.inf)
    median = float(np.median(delays))
    return str(rate([bool(np.isfinite(d)) for d in delays])), f"{median:.0f}" if np.isfinite(median) else "–"
