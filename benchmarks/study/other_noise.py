"""Noise that is not normal, or differs ten times between sensors; and arbitrary orientations beside the stand, with
gyros, and as logs that settle after each turn."""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from dataclasses import replace as changed
from typing import Any

import numpy as np

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from benchmarks.study.rests import SCATTER, settling, with_gyros
from benchmarks.study.stated_noise import HIDDEN, NOISE, restated
from benchmarks.study.stated_noise import Wish as Stated
from benchmarks.study.turned_pairs import PROGRAMMES, Programme, draw_pair
from benchmarks.study.turned_pairs import Wish as Pair
from estimator import Diagnosis, diagnose, read_session
from tests.blind.case import Case, Draw, written
from tests.blind.cases import KINDS, LONGEST, TRIES
from tests.blind.draw import draw_session
from tests.blind.hide import UnhideableError
from tests.blind.physics import measure

TAIL = 4.0
"""Degrees of freedom of Student's t: of a hundred readings one lies beyond 3.2 standard deviations."""
NOISIER = 10.0
STRENGTH = 12.0
ORIENTATIONS = [p for p in PROGRAMMES if p.name.startswith("orientations")]

INTRODUCTION = (
    "Noise with heavy tails, sensors of unequal noise, blocks in arbitrary orientations whose errors are stated right "
    "or wrong, blocks with gyros, and logs that settle after each turn."
)
DESCRIBED = (
    "Noise of the variance that is stated, but with the tails of Student's t with four degrees of freedom; one sensor "
    "ten times as noisy as the others, and stated so. And blocks in 24 arbitrary orientations, their errors stated "
    "right, too small, too large, or with such tails. The effect is of strength 12 on the stand; in orientations it is "
    "a zero that jumps, fifteen standard errors in all, of which parameters and unknown directions take up more than "
    "half in some. Such blocks with three gyros, of which it is a gyro's zero that jumps. And such blocks as logs of "
    "rests of six seconds in which each turn leaves every zero off by another amount, three noises of a sample, that "
    "settles within a second: means are off by nine of their white standard errors, and the jump is fifteen of these."
)


class Tailed(np.random.Generator):
    """Draws normal deviates from Student's t, of variance one."""

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Deviates of variance one."""
        return self.standard_t(TAIL, size) / np.sqrt(TAIL / (TAIL - 2))


@dataclass(frozen=True)
class Wish:
    """One session."""

    world: str
    hidden: bool
    seed: tuple[int, ...]


@dataclass(frozen=True)
class Answer:
    """The answer to one session."""

    wish: Wish
    other_name: bool
    offered: bool
    unexplained: bool


@dataclass(frozen=True)
class Hidden:
    """A session with its history, and what acts."""

    session: dict[str, Any]
    history: list[dict[str, Any]]
    causes: frozenset[str]


def tailed(seed: tuple[int, ...]) -> np.random.Generator:
    """Heavy tails."""
    return Tailed(np.random.PCG64(list(seed)))


def on_stand(wish: Wish) -> Hidden:
    """Tails, with or without an effect."""
    cause = HIDDEN[wish.seed[-1] % len(HIDDEN)] if wish.hidden else None
    for attempt in range(TRIES):
        draw = Draw("-".join(map(str, wish.seed)), tailed((*wish.seed, attempt)), LONGEST)
        try:
            case: Case = KINDS["twelve" if wish.hidden else "none"](draw, cause)
        except UnhideableError:
            continue
        if case.world.noise.stated:
            return Hidden(case.session, case.history, frozenset(t.effect.cause for t in case.truths))
    raise UnhideableError(str(wish))


def unequal(wish: Wish) -> Hidden:
    """One sensor ten times noisier, as stated; nothing acts."""
    rng = np.random.default_rng(wish.seed)
    drawn = draw_session(rng, frozenset({"stated noise"}), LONGEST)
    times = np.ones(drawn.unit.size)
    times[rng.integers(drawn.unit.size)] = NOISIER
    noise = changed(drawn.noise, reading=times * drawn.noise.reading, repeatability=times * drawn.noise.repeatability)
    session = changed(drawn, noise=noise)
    draw = Draw("-".join(map(str, wish.seed)), rng, LONGEST)
    return Hidden(written(draw, "none", session, measure(session, [], rng)[0], ()).session, [], frozenset())


def in_orientations(wish: Wish, factor: float = 1.0, tails: bool = False) -> Hidden:
    """A block in arbitrary orientations, its stated errors times a factor."""
    rng = tailed(wish.seed) if tails else np.random.default_rng(wish.seed)
    programme: Programme = ORIENTATIONS[wish.seed[-1] % len(ORIENTATIONS)]
    session = draw_pair(Pair(programme, 0.0), rng).session
    if wish.hidden:
        session = with_jump(session, rng)
    return Hidden(restated(session, Stated(factor, "all", wish.hidden, wish.seed, "")), [], jump_of(wish))


def beside_gyros(wish: Wish) -> Hidden:
    """A block with gyros, one of which may jump."""
    rng = np.random.default_rng(wish.seed)
    session = with_gyros(draw_pair(Pair(ORIENTATIONS[0], 0.0), rng).session, rng)
    return Hidden(with_jump(session, rng, "gyroscope") if wish.hidden else session, [], jump_of(wish))


def in_logs(wish: Wish) -> Hidden:
    """A block whose zeros settle after each turn."""
    rng = np.random.default_rng(wish.seed)
    session = draw_pair(Pair(ORIENTATIONS[0], 0.0), rng).session
    session = with_jump(session, rng, times=SCATTER) if wish.hidden else session
    return Hidden(settling(session, rng), [], jump_of(wish))


def jump_of(wish: Wish) -> frozenset[str]:
    """The cause that acts, where one is wished."""
    return frozenset({"bias-jump"} if wish.hidden else ())


def with_jump(
    session: dict[str, Any], rng: np.random.Generator, kind: str = "accelerometer", times: float = 1.0
) -> dict[str, Any]:
    """The zero of one sensor jumps in the middle half: `STRENGTH` and a fourth more in all, in so many standard
    errors."""
    document = json.loads(json.dumps(session))
    name = str(rng.choice([sensor["name"] for sensor in document["sensors"] if sensor["kind"] == kind]))
    readings, error = np.array(document["table"][name]), document["table"][f"{name}_se"][0]
    rows = len(readings)
    step = np.arange(rows) >= rng.integers(rows // 4, 3 * rows // 4)
    size = times * STRENGTH * error / np.sqrt(rows * step.mean() * (1 - step.mean()))
    document["table"][name] = (readings + 1.25 * size * step).tolist()
    return dict(document)


WORLDS: dict[str, Callable[[Wish], Hidden]] = {
    "stand, heavy tails": on_stand,
    "stand, one sensor ten times noisier": unequal,
    "orientations": in_orientations,
    "orientations, stated × ⅓": lambda wish: in_orientations(wish, 1 / 3),
    "orientations, stated × 3": lambda wish: in_orientations(wish, 3.0),
    "orientations, heavy tails": lambda wish: in_orientations(wish, tails=True),
    "orientations, gyros beside": beside_gyros,
    "orientations, logs that settle after each turn": in_logs,
}
ONLY_SOUND = {"stand, one sensor ten times noisier"}


def wishes(sessions: int, seed: int) -> Iterator[Wish]:
    """Wishes for ``sessions`` sound sessions of every world, and a third as many with an effect."""
    for number, world in enumerate(WORLDS):
        yield from (Wish(world, False, (seed, number, 0, k)) for k in range(sessions))
        with_effect = 0 if world in ONLY_SOUND else sessions // 3
        yield from (Wish(world, True, (seed, number, 1, k)) for k in range(with_effect))


def perform(wish: Wish, diagnosing: Callable[..., Diagnosis] = diagnose) -> Answer:
    """Draw and diagnose."""
    hidden = WORLDS[wish.world](wish)
    found = diagnosing(read_session(hidden.session), history=[read_session(h) for h in hidden.history])
    names = {f.cause for f in found.findings}
    offered = names | {other for f in found.findings for other in f.alternatives}
    return Answer(wish, bool(names - {NOISE}), bool(hidden.causes & offered), found.unexplained)


def section(answers: list[Answer]) -> str:
    """Markdown."""
    rows = []
    for world in ("all", *WORLDS):
        own = [a for a in answers if world in ("all", a.wish.world)]
        sound, hidden = [a for a in own if not a.wish.hidden], [a for a in own if a.wish.hidden]
        named, unexplained = rate([a.other_name for a in sound]), rate([a.unexplained for a in sound])
        rows.append((world, named, unexplained, rate([a.offered for a in hidden])))
    head = ("world", "sound: a name other than noise", "sound: `unexplained`", "an effect: named or listed")
    worlds = in_full(f"{DESCRIBED}\n\n{table(head, rows[1:])}")
    return f"## Other noise, other programmes\n\n{INTRODUCTION}\n\n{table(head, rows[:1])}\n\n{worlds}"
