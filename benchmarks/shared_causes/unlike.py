"""Sound sessions whose errors have tails, and sensors that are noisier than stated."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from benchmarks.study.rates import rate
from estimator import diagnose, read_session
from estimator.session import Array
from tests.blind.steps import BLOCKS, Block, directions, session_of, steps_file
from tests.blind.world import Session

STAND, _, SIX, TWELVE = BLOCKS
SHARE, TIMES = 0.03, 5.0
"""Share of the readings with contaminated errors, and how many times as large these are."""
FACTORS = (3.5, 5.0)
OUTLIER, NOISE = "reading-outlier", "excess-noise"

Line = tuple[str, str, str]
"""Words, target and measured value of a line."""


def student(freedom: float) -> Callable[[np.random.Generator, Any], Any]:
    """Errors of Student's law and variance one."""
    return lambda rng, size: rng.standard_t(freedom, size) / np.sqrt(freedom / (freedom - 2))


def contaminated(rng: np.random.Generator, size: Any) -> Any:
    """Normal errors some of which are larger, of variance one together."""
    larger = np.where(rng.random(size) < SHARE, TIMES, 1.0)
    return larger * rng.normal(size=size) / np.sqrt(1 + SHARE * (TIMES**2 - 1))


LAWS: dict[str, Callable[[np.random.Generator, Any], Any]] = {
    **{f"Student's errors, ν = {freedom}": student(freedom) for freedom in (3, 4, 6)},
    f"{100 * SHARE:.0f} % of errors {TIMES:.0f} times as large": contaminated,
}


class Unlike(np.random.Generator):
    """Draws errors that are not normal."""

    law: Callable[[np.random.Generator, Any], Any]

    def standard_normal(self, size: Any = None, *_: Any, **__: Any) -> Any:
        """Errors of variance one."""
        return self.law(self, size)


def errors(law: str, seed: tuple[int, ...]) -> Unlike:
    """A generator of one of `LAWS`."""
    rng = Unlike(np.random.PCG64(list(seed)))
    rng.law = LAWS[law]
    return rng


@dataclass(frozen=True)
class Scene:
    """A scene to measure, before its errors."""

    block: Block
    world: Session
    up: Array

    @classmethod
    def drawn(cls, block: Block, seed: tuple[int, ...]) -> "Scene":
        """Unit, stand, schedule and noise, all of normal deviates."""
        rng = np.random.default_rng(seed)
        return cls(block, session_of(block, rng), directions(rng))

    def file(self, rng: np.random.Generator) -> dict[str, Any]:
        """The session file; nothing acts."""
        rows = self.world.schedule.rows if self.block.stand else len(self.up)
        return steps_file(self.block, self.world, self.up, np.zeros((rows, self.world.unit.size)), rng)


def names_of(document: dict[str, Any]) -> frozenset[tuple[str, tuple[str, ...]]]:
    """Causes named, with their sensors."""
    return frozenset((f.cause, f.sensors) for f in diagnose(read_session(document)).findings)


def tails(sessions: int, seed: int) -> Iterator[Line]:
    """Lines for every law, on a stand and in orientations."""
    for number, law in enumerate(LAWS):
        for block in (STAND, SIX):
            seeds = [(seed, 1, number, BLOCKS.index(block), k) for k in range(sessions)]
            found = [names_of(Scene.drawn(block, own).file(errors(law, (*own, 1)))) for own in seeds]
            yield (
                f"sound, {law}, {block.name}: any name, of single readings too",
                "",
                str(rate([bool(names) for names in found])),
            )
            others = [any(cause != OUTLIER for cause, _ in names) for names in found]
            yield f"sound, {law}, {block.name}: a name other than of single readings", "≤ 2 %", str(rate(others))


def noisier(sessions: int, seed: int) -> Iterator[Line]:
    """One sensor so many times noisier than stated, in orientations."""
    for number, factor in enumerate(FACTORS):
        for block in (SIX, TWELVE):
            marks = [
                _is_called_noise(block, factor, (seed, 2, number, BLOCKS.index(block), k)) for k in range(sessions)
            ]
            words = f"one sensor {factor:g} times noisier than stated, {block.name}"
            yield f"{words}: called noise", "≥ 90 %", str(rate([right for right, _ in marks]))
            yield f"{words}: anything else named", "", str(rate([other for _, other in marks]))


def _is_called_noise(block: Block, factor: float, seed: tuple[int, ...]) -> tuple[bool, bool]:
    """Whether the sensor's noise is named, and whether anything else is."""
    scene, rng = Scene.drawn(block, seed), np.random.default_rng((*seed, 1))
    noise = scene.world.noise.reading.copy()
    number = int(rng.integers(len(noise)))
    name = scene.world.unit.names[number]
    noise[number] *= factor
    world = replace(scene.world, noise=replace(scene.world.noise, reading=noise))
    document = replace(scene, world=world).file(rng)
    document["table"][f"{name}_se"] = [error / factor for error in document["table"][f"{name}_se"]]
    names = names_of(document)
    return (NOISE, (name,)) in names, bool(names - {(NOISE, (name,))})
