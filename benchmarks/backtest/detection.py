"""What is found, and how often by mistake: on whole histories, and beside the rules that are used instead."""

import numpy as np

from benchmarks.backtest.histories import History, Plan, dates, history
from benchmarks.backtest.rivals import EVENTS, RIVALS, Rule, figures, optimum
from benchmarks.backtest.units import PARAMETERS
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.health.detection import detect
from estimator.health.fits import Readings
from estimator.session import Array

LEVEL = 0.05
SINGLE = float(-np.expm1(np.log1p(-LEVEL) / PARAMETERS))
"""Of one parameter, at 5 % over all of a unit."""
PLANS = {"6 to 16 sessions": Plan(since=1), "17 to 60 sessions": Plan(sessions=(17, 60), since=1)}
"""A change may show in the last session alone."""
LEVELS = (0.01, 0.05, 0.2, 0.5, 0.8)


def p_value(one: History) -> float:
    """Of the estimator, noise known and no walk expected."""
    n = len(one.time)
    readings = Readings(one.time, one.value[:, None], one.sigma[:, None], np.ones((n, 1)), np.ones(1))
    return detect(readings, 0.0, np.full(n, np.inf), np.full(n, np.nan), 0.0).p_value


def suspicion(one: History) -> float:
    """−ln p."""
    return float(-np.log(max(p_value(one), 1e-300)))


def made(kind: str, count: int, plan: Plan, rng: np.random.Generator) -> list[History]:
    """So many histories of a kind."""
    return [history(kind, dates(plan, rng), plan, rng) for _ in range(count)]


def found(kind: str, count: int, rng: np.random.Generator) -> list[bool]:
    """Whether a change is found at 5 % over all parameters of its unit."""
    return [p_value(one) < SINGLE for one in made(kind, count, PLANS["6 to 16 sessions"], rng)]


def alarms_page(count: int, rng: np.random.Generator) -> str:
    """Markdown: p-values where nothing happens."""
    rows = []
    for name, plan in {"3 to 5 sessions": Plan(sessions=(3, 5)), **PLANS}.items():
        p = np.array([p_value(one) for one in made("stable", count, plan, rng)])
        rows.append((name, *(str(rate([bool(x) for x in p < level])) for level in LEVELS)))
    head = ("stable", *(f"p < {level:g}" for level in LEVELS))
    return "## Are p-values what they say?\n\nWhere nothing happens.\n\n" + table(head, rows)


def rivals_page(count: int, rng: np.random.Generator) -> tuple[str, dict[str, tuple[float, float]]]:
    """Markdown, and of every event what is found by the estimator and by the optimum, 0 … 1."""
    plan = PLANS["6 to 16 sessions"]
    still = made("stable", 2 * count, plan, rng)
    events = {kind: made(kind, count, plan, rng) for kind in EVENTS}
    rules: dict[str, Rule] = {"the likelihood of all changes (ours)": suspicion, "the optimum": optimum, **RIVALS}
    rows, shares = [], list[Array]()
    for name, rule in rules.items():
        threshold = float(np.quantile(figures(rule, still), 1 - LEVEL))
        hits = {kind: figures(rule, one) > threshold for kind, one in events.items()}
        shares.append(np.array([hit.mean() for hit in hits.values()]))
        rows.append((name, *(str(rate([bool(x) for x in hit])) for hit in hits.values())))
    text = (
        "## Beside other rules, at equal false alarms\n\n"
        f"Every rule has the threshold at which {100 * LEVEL:.0f} % of stable histories raise an alarm. The optimum "
        "knows the generator's own changes and their shares; no rule finds more of their mixture.\n\n"
    )
    both = {kind: (float(shares[0][i]), float(shares[1][i])) for i, kind in enumerate(EVENTS)}
    return text + table(("rule", *EVENTS), rows), both
