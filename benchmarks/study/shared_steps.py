"""Zeros of several sensors that step at one row: named as one event with all its sensors; and what must not be."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import diagnose, read_session
from tests.blind.steps import BLOCKS, OTHERS, RAMPS, TURNED, WALKS, Block, Stepped, draw_others, draw_steps

STRENGTHS = (5.0, 8.0, 12.0)
LARGE = 80.0
OTHER = 20.0
"""Strength of what is no step."""
TOGETHER = 12.0
COUNTS = (1, 2, 3, 4, 5, 6)
SOUND = {"stand, 6 accelerometers": 75, "orientations, 6 accelerometers": 25}
"""Times as many sessions in which nothing acts."""
APART = 8
"""Times as many in which every sensor steps at a row of its own, and of each other thing that is no shared step."""
SHARED = "at one moment"
"""Words in the sentence of an event."""

UNLIKE = {
    WALKS: f"every zero walks by itself, strength {OTHER:g} each: called one event",
    RAMPS: f"every zero begins to drift at a row of its own, strength {OTHER:g} each: called one event",
    TURNED: f"the block turns in its mounting at one row, strength {OTHER:g} together: called a step of zeros",
}

INTRODUCTION = (
    "The zeros of some of six sensors step at one row. Right is one `bias-jump` of exactly these sensors at this row, "
    "and no other name."
)
PLAIN = 8
"""Strength from which a step is well above the detection limit of one sensor."""


@dataclass(frozen=True)
class Wish:
    """One session."""

    block: Block
    strength: float
    """Strength of each sensor, standard errors; of all together where `together`."""
    count: int
    seed: tuple[int, ...]
    together: bool = False
    apart: bool = False
    other: str = ""
    """An acting cause that is no step."""


@dataclass(frozen=True)
class Answer:
    """The answer to one session."""

    wish: Wish
    right: bool
    found: bool
    """Whether a jump is named at all."""
    other: bool
    """Whether something else is named."""
    shared: bool
    """Whether it is called one event."""


def wishes(sessions: int, seed: int) -> Iterator[Wish]:
    """Wishes for ``sessions`` sessions of every number of sensors and strength; for sound ones, and steps apart."""
    stand, orientations = BLOCKS[0], BLOCKS[2]
    kinds = [(stand, s, False) for s in STRENGTHS] + [(stand, TOGETHER, True), (orientations, STRENGTHS[-1], False)]
    kinds += [(stand, LARGE, False), (orientations, LARGE, False)]
    for number, (block, strength, together) in enumerate(kinds):
        for count in COUNTS:
            yield from (Wish(block, strength, count, (seed, number, count, k), together) for k in range(sessions))
    for number, block in enumerate((stand, orientations)):
        yield from (Wish(block, 0.0, 0, (seed, 90 + number, k)) for k in range(SOUND[block.name] * sessions))
    yield from (Wish(stand, 8.0, 2 + k % 5, (seed, 99, k), apart=True) for k in range(APART * sessions))
    for number, kind in enumerate(OTHERS):
        for k in range(APART * sessions):
            block = orientations if k % 2 and kind != TURNED else stand
            yield Wish(block, OTHER, 6, (seed, 80 + number, k), other=kind)


def drawn(wish: Wish) -> Stepped:
    """The session."""
    rng = np.random.default_rng(wish.seed)
    if wish.other:
        return draw_others(wish.block, wish.other, wish.strength, rng)
    each = wish.strength / np.sqrt(max(wish.count, 1)) if wish.together else wish.strength
    return draw_steps(wish.block, np.full(wish.count, each), rng, apart=wish.apart)


def perform(wish: Wish) -> Answer:
    """Draw and diagnose."""
    hidden = drawn(wish)
    named = diagnose(read_session(hidden.session)).findings
    jumps = [f for f in named if f.cause == "bias-jump"]
    right = len(named) == len(jumps) == 1 and set(jumps[0].sensors) == set(hidden.sensors)
    right = right and {shape["row"] for shape in jumps[0].nonlinear_each} == set(hidden.rows)
    shared = any(SHARED in f.sentence for f in jumps)
    return Answer(wish, right, bool(jumps), len(jumps) < len(named), shared)


def section(answers: list[Answer]) -> str:
    """Markdown."""
    rows = []
    for block, strength, together in dict.fromkeys((a.wish.block, a.wish.strength, a.wish.together) for a in answers):
        own = [a for a in answers if (a.wish.block, a.wish.strength, a.wish.together) == (block, strength, together)]
        own = [a for a in own if _steps_at_once(a)]
        if own:
            each = [[a.right for a in own if a.wish.count == count] for count in COUNTS]
            kind = "together" if together else "each"
            rows.append((f"{block.name}, {strength:g} {kind}", *(f"{sum(right)} of {len(right)}" for right in each)))
    right = table(("strength", *(f"{count} of 6" for count in COUNTS)), rows)
    apart = [a for a in answers if a.wish.apart]
    strong = rate([a.right for a in answers if _steps_at_once(a) and a.wish.strength >= PLAIN])
    sound = [(f"sound, {name}: a name", rate([a.found or a.other for a in _sound(answers, name)])) for name in SOUND]
    several = [("2 to 6 steps, each at a row of its own: called one event", rate([a.shared for a in apart]))]
    several += [(words, rate([a.shared for a in answers if a.wish.other == kind])) for kind, words in UNLIKE.items()]
    shared = ("1 to 6 sensors step together, strength 8 and more: right", strong)
    head = ("sessions", "measured")
    details = in_full(f"{table(head, several)}\n\n{right}")
    return f"## Steps that sensors share\n\n{INTRODUCTION}\n\n{table(head, [shared, *sound])}\n\n{details}"


def _steps_at_once(answer: Answer) -> bool:
    return answer.wish.count > 0 and not (answer.wish.apart or answer.wish.other)


def _sound(answers: list[Answer], name: str) -> list[Answer]:
    return [a for a in answers if not a.wish.count and a.wish.block.name == name]
