"""Names given when the standard errors in the file are wrong, of one sensor, some or all, too large or too small."""

import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import Diagnosis, diagnose, read_session
from tests.blind.case import Case
from tests.blind.cases import draw_case
from tests.blind.catalogue import CATALOGUE, DISCRETE

FACTORS = (0.1, 1 / 3, 1.0, 3.0)
WHO = ("one", "half", "all")
HIDDEN = tuple(c for c in CATALOGUE if c not in DISCRETE | {"excess-noise"})
NOISE = "excess-noise"
SOUND = 3
"""Sound sessions for every one with an effect: a share of one in a hundred is told by some hundred sessions."""

REPEATED = ("bias_repeatability_m_s2", "bias_repeatability_rad_s")

INTRODUCTION = (
    "The standard errors in the file are the true ones times 0.1 to 3, of one sensor, of half of them or of all; in "
    "sound sessions, and with one effect of 12 true standard errors."
)


@dataclass(frozen=True)
class Wish:
    """One session."""

    factor: float
    who: str
    hidden: bool
    seed: tuple[int, ...]
    cause: str


@dataclass(frozen=True)
class Answer:
    """The answer to one session."""

    wish: Wish
    other_name: bool
    """A name other than noise."""
    offered: bool
    """The hidden cause is named or listed."""
    unexplained: bool
    said: bool
    """Noise, or the scale of noise, is said to be wrong."""


def wishes(sessions: int, seed: int) -> Iterator[Wish]:
    """Wishes for ``sessions`` sessions of every kind with an effect, and for more sound ones."""
    kinds = list(product(FACTORS, WHO, (False, True)))
    for k, (factor, who, hidden) in product(range(SOUND * sessions), kinds):
        if hidden and k >= sessions:
            continue
        place = (seed, k, round(10 * factor), WHO.index(who))
        yield Wish(factor, who, hidden, place, HIDDEN[(7 * k + 3 * WHO.index(who) + round(10 * factor)) % len(HIDDEN)])


def perform(wish: Wish, diagnosing: Callable[..., Diagnosis] = diagnose) -> Answer:
    """Draw, state wrongly, diagnose."""
    case = stated_case(wish)
    session = restated(case.session, wish)
    found = diagnosing(read_session(session), history=[read_session(restated(h, wish)) for h in case.history])
    names = {f.cause for f in found.findings}
    offered = names | {other for f in found.findings for other in f.alternatives}
    truth = {t.effect.cause for t in case.truths}
    said = NOISE in names or bool(found.noise)
    return Answer(wish, bool(names - {NOISE}), bool(truth & offered), found.unexplained, said)


def stated_case(wish: Wish) -> Case:
    """The first case that states its noise."""
    kind, cause = ("twelve", wish.cause) if wish.hidden else ("none", None)
    draws = (draw_case(kind, (*wish.seed, k), cause) for k in range(40))
    return next(case for case in draws if case.world.noise.stated)


def restated(session: dict[str, Any], wish: Wish) -> dict[str, Any]:
    """The file with wrong standard errors."""
    changed = deepcopy(json.loads(json.dumps(session)))
    count = {"one": 1, "half": (len(changed["sensors"]) + 1) // 2, "all": len(changed["sensors"])}[wish.who]
    for sensor in changed["sensors"][:count]:
        sensor |= {name: wish.factor * sensor[name] for name in REPEATED if name in sensor}
        column = f"{sensor['name']}_se"
        changed["table"][column] = (wish.factor * np.array(changed["table"][column])).tolist()
    return changed


def section(answers: list[Answer]) -> str:
    """Markdown."""
    sound = [a for a in answers if not a.wish.hidden]
    hidden = [a for a in answers if a.wish.hidden]
    rows = [
        ("sound session: a name other than noise", "≤ 1 %", rate([a.other_name for a in sound])),
        ("one effect of strength 12: named or listed", "≥ 95 %", rate([a.offered for a in hidden])),
        ("sound session: `unexplained`", "", rate([a.unexplained for a in sound])),
    ]
    lines = [
        (f"{factor:.2g}", who, *_cells([a for a in answers if (a.wish.factor, a.wish.who) == (factor, who)]))
        for factor, who in product(FACTORS, WHO)
    ]
    head = ("stated over true", "of", "sound: other name", "sound: noise called wrong", "strength 12: named or listed")
    return (
        f"## Stated noise\n\n{INTRODUCTION}\n\n"
        + table(("figure", "target", "measured"), rows)
        + "\n\n"
        + in_full(table(head, lines))
    )


def _cells(own: list[Answer]) -> tuple[str, str, str]:
    sound, hidden = [a for a in own if not a.wish.hidden], [a for a in own if a.wish.hidden]
    marks = [a.other_name for a in sound], [a.said for a in sound], [a.offered for a in hidden]
    return tuple(f"{sum(m)} of {len(m)}" for m in marks)  # type: ignore[return-value]
