"""Changes found and false alarms: on whole histories, and beside other rules in use."""

from dataclasses import dataclass

import numpy as np

from benchmarks.backtest.histories import History, Plan
from benchmarks.backtest.rivals import EVENTS, RIVALS, Rule, figures, log_ratios, optimum
from benchmarks.backtest.units import PARAMETERS, learned, unit
from benchmarks.backtest.worlds import FIRST, World
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator.health.detection import detect
from estimator.health.error_laws import NORMAL
from estimator.health.fits import Readings, fits
from estimator.health.odds import mixture, odds
from estimator.health.shapes import shapes
from estimator.session import Array

LEVEL = 0.05
SINGLE = float(-np.expm1(np.log1p(-LEVEL) / PARAMETERS))
"""Level for one parameter, at 5 % over all of a unit."""
OURS, BEST, ODDS = "the likelihood of all changes (ours)", "the optimum", "the odds behind ours"
TWO_SIDED = 1.96
"""Standard errors either way of an interval of 95 %."""
LEVELS = (0.01, 0.05, 0.2, 0.5, 0.8)


def readings(one: History, tails: Array = NORMAL) -> Readings:
    """The readings as the estimator takes them, noise known; ``tails`` (4,) the chance of each law of errors."""
    n = len(one.time)
    return Readings(one.time, one.value[:, None], one.sigma[:, None], np.ones((n, 1)), np.ones(1), tails)


def p_value(one: History, tails: Array = NORMAL) -> float:
    """The estimator's p-value, no walk expected."""
    n = len(one.time)
    return detect(readings(one, tails), 0.0, np.full(n, np.inf), np.full(n, np.nan), 0.0).p_value


def suspicion(one: History) -> float:
    """−ln p."""
    return float(-np.log(max(p_value(one), 1e-300)))


def log_odds(one: History) -> float:
    """The estimator's log odds of any change against none: not yet a p-value for the history's own schedule."""
    null = fits(readings(one), shapes(one.time), np.zeros(1))
    tells = (null.information[0] > 0).all(axis=0)
    return odds(mixture(null, one.time, tells), null.z[0]).total


def tails_of(world: World, rng: np.random.Generator) -> Array:
    """(4,) chance of each law of errors, as twenty units of a type tell it."""
    return learned([unit(world, kind, world.plan, rng) for kind in world.fleet]).tails


def made(world: World, kind: str, of: tuple[int, Plan], rng: np.random.Generator) -> list[History]:
    """Histories of one kind: how many, and by what plan, is ``of``."""
    count, plan = of
    return [world.made(kind, plan, rng) for _ in range(count)]


def found(kind: str, count: int, tails: Array, rng: np.random.Generator) -> list[bool]:
    """Whether a change is found in each history, at 5 % over all parameters of its unit."""
    return [p_value(one, tails) < SINGLE for one in made(FIRST, kind, (count, FIRST.plan), rng)]


def alarms_page(world: World, of: tuple[int, Array], rng: np.random.Generator) -> str:
    """Markdown: p-values where nothing happens, of so many histories, errors being as a type tells; and taken for
    normal ones."""
    (count, tails), rows = of, []
    for plan in (world.planned((3, 5)), world.plan, world.long):
        still = made(world, world.still, (count, plan), rng)
        for name, law in (("", tails), (", errors taken for normal", NORMAL)):
            p = np.array([p_value(one, law) for one in still])
            rows.append((_sessions(plan) + name, *(str(rate([bool(x) for x in p < level])) for level in LEVELS)))
    head = (world.still, *(f"p < {level:g}" for level in LEVELS))
    text = (
        "### Are p-values what they say?\n\nWhere nothing happens. Tails of errors are learned from twenty units.\n\n"
    )
    return text + table(head, rows)


def _sessions(plan: Plan) -> str:
    fewest, most = plan.sessions
    return f"{fewest} to {most} sessions"


def beside_page(world: World, count: int, rng: np.random.Generator) -> str:
    """Markdown: what the estimator finds and what the rules find that are used instead, at equal false alarms."""
    still = made(world, world.still, (2 * count, world.plan), rng)
    events = {kind: made(world, kind, (count, world.plan), rng) for kind in world.kinds[1:]}
    rules: dict[str, Rule] = {OURS: suspicion, ODDS: log_odds, **RIVALS}
    rows = [(name, *(str(rate(hit)) for hit in _hits(rule, still, events).values())) for name, rule in rules.items()]
    return "### Beside other rules, at equal false alarms\n\n" + table(("rule", *events), rows)


def _hits(rule: Rule, still: list[History], events: dict[str, list[History]]) -> dict[str, list[bool]]:
    """Hits of a rule by kind, at a threshold where it raises an alarm in 5 % of still histories."""
    threshold = float(np.quantile(figures(rule, still), 1 - LEVEL))
    return {kind: [bool(x) for x in figures(rule, one) > threshold] for kind, one in events.items()}


def _alone(still: list[History], events: dict[str, list[History]]) -> list[list[bool]]:
    """Hits of every kind by its own likelihood ratio."""
    nothing, hits = [log_ratios(one) for one in still], []
    for kind, histories in events.items():
        threshold = float(np.quantile([ratios[kind] for ratios in nothing], 1 - LEVEL))
        hits.append([log_ratios(one)[kind] > threshold for one in histories])
    return hits


@dataclass(frozen=True)
class Compared:
    """Hits of the estimator, of its odds and of the optimum for one kind of change, at equal false alarms."""

    ours: list[bool]
    odds: list[bool]
    optimum: list[bool]

    def __str__(self) -> str:
        """The three rates, and by how much the estimator's falls short of the optimum's, with its 95 % interval."""
        less = np.array(self.optimum, dtype=float) - np.array(self.ours, dtype=float)
        sigma = float(less.std()) / np.sqrt(len(less))
        found = (f"{100 * np.mean(every):.1f} %" for every in (self.ours, self.odds, self.optimum))
        return f"{', '.join(found)}: {100 * less.mean():.1f} ± {100 * TWO_SIDED * sigma:.1f} less, of {len(less)}"


def rivals_page(count: int, rng: np.random.Generator) -> tuple[str, dict[str, Compared]]:
    """Markdown, and every event's comparison with the optimum."""
    still = made(FIRST, FIRST.still, (2 * count, FIRST.plan), rng)
    events = {kind: made(FIRST, kind, (count, FIRST.plan), rng) for kind in EVENTS}
    rules: dict[str, Rule] = {OURS: suspicion, BEST: optimum, ODDS: log_odds, **RIVALS}
    hits = {name: _hits(rule, still, events) for name, rule in rules.items()}
    rows = [(name, *(str(rate(hit)) for hit in every.values())) for name, every in hits.items()]
    rows.insert(2, ("likelihood ratio of that kind alone", *(str(rate(hit)) for hit in _alone(still, events))))
    text = (
        "### Beside other rules, at equal false alarms\n\n"
        f"Every rule has the threshold at which {100 * LEVEL:.0f} % of stable histories raise an alarm. The optimum "
        "is the likelihood ratio of the generator's changes in equal shares: no rule finds more of their mixture "
        "(Neyman and Pearson); the likelihood ratio of one kind bounds that kind. Ours is a p-value, uniform in every "
        "history; the odds behind it have one threshold for all histories, as the optimum has.\n\n"
    )
    return text + table(("rule", *EVENTS), rows), {
        kind: Compared(hits[OURS][kind], hits[ODDS][kind], hits[BEST][kind]) for kind in EVENTS
    }
