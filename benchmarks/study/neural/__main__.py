"""``python -m benchmarks.study.neural --minutes 60`` trains the network and writes its weights to build/neural.npz.

Adam (Kingma and Ba 2015), its rate falling as a cosine to nothing at the end of the time. Needs what `make bench`
installs: jax, for derivatives. `benchmarks.study.detection --network build/neural.npz` sets it beside the diagnosis.
"""

import argparse
import sys
import time
from itertools import count
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np

from benchmarks.details import PROJECT
from benchmarks.study.detection import HIDDEN
from benchmarks.study.neural.lessons import Lesson, draw, lesson
from benchmarks.study.neural.network import Design, Weights, log_posterior, starting
from estimator.session import Array
from tests.blind.catalogue import CATALOGUE, SENSOR

OWN = tuple(cause for cause in HIDDEN if CATALOGUE[cause].scope == SENSOR)
SHARED = tuple(cause for cause in HIDDEN if CATALOGUE[cause].scope != SENSOR)
DRAWING = 0.15
"""Share of the time in which sessions are drawn."""
DESIGNS, DRAWS = 16, 32
RATE, DECAY = 2e-3, (0.9, 0.99)
State = tuple[Weights, Weights, Weights]
"""Weights and both moments."""


def loss(w: Weights, design: Design, z: Array, labels: Array) -> jax.Array:
    """Mean log loss."""
    return -jnp.take_along_axis(log_posterior(w, design, z, jnp), labels[..., None], axis=-1).mean()


@jax.jit
def stepped(state: State, given: tuple[Design, Array, Array], rate: float, k: int) -> tuple[State, jax.Array]:
    """One step of Adam, the k-th."""
    w, first, second = state
    value, slope = jax.value_and_grad(loss)(w, *given)
    first = jax.tree.map(lambda m, g: DECAY[0] * m + (1 - DECAY[0]) * g, first, slope)
    second = jax.tree.map(lambda s, g: DECAY[1] * s + (1 - DECAY[1]) * g**2, second, slope)
    step = rate * jnp.sqrt(1 - DECAY[1] ** k) / (1 - DECAY[0] ** k)
    return (jax.tree.map(lambda x, m, s: x - step * m / (jnp.sqrt(s) + 1e-8), w, first, second), first, second), value


def trained(sizes: list[Lesson], seconds: float, rng: np.random.Generator) -> tuple[Weights, int]:
    """Weights, and the number of steps that there was time for."""
    begun, gone = time.monotonic(), 0.0
    w = starting(sizes[0].design.known.shape[-1], (len(OWN), len(SHARED)), rng)
    state = (w, *(jax.tree.map(np.zeros_like, w) for _ in range(2)))
    for k in count(1):
        state, value = stepped(state, batch(sizes, rng), RATE * 0.5 * (1 + np.cos(np.pi * gone)), k)
        gone = min((time.monotonic() - begun) / seconds, 1.0)
        if k % 100 == 0 or gone == 1:
            print(f"\r{gone:.0%}, {k} steps, log loss {float(value):.3f}", end="", file=sys.stderr)
        if gone == 1:
            break
    return {name: np.asarray(x) for name, x in state[0].items()}, k


def batch(sizes: list[Lesson], rng: np.random.Generator) -> tuple[Design, Array, Array]:
    """Draws of some sessions of one size, which is chosen as often as it comes."""
    share = np.array([len(size.labels) for size in sizes])
    size = sizes[rng.choice(len(sizes), p=share / share.sum())]
    chosen = rng.integers(len(size.labels), size=DESIGNS)
    return draw(jax.tree.map(lambda x: x[chosen], size), DRAWS, rng)[:3]


def by_size(lessons: list[Lesson]) -> list[Lesson]:
    """The lessons of one size, stacked."""
    sizes = sorted({n.free.shape for n in lessons})
    return [jax.tree.map(lambda *x: np.stack(x), *[n for n in lessons if n.free.shape == s]) for s in sizes]


def held_out(w: Weights, lessons: list[Lesson], rng: np.random.Generator) -> tuple[float, float]:
    """Mean log loss of sessions that took no part: the network's, and that of the prior."""
    found = list[tuple[Array, Array]]()
    for n in lessons:
        design, z, labels, prior = draw(by_size([n])[0], DRAWS, rng)
        found.append((-np.take_along_axis(log_posterior(w, design, z), labels[..., None], axis=-1)[..., 0], prior))
    network, prior = np.mean(found, axis=(0, 2, 3))
    return float(network), float(prior)


def main() -> None:
    """Draw sessions, learn, write the weights."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.neural", description=__doc__)
    parser.add_argument("--minutes", type=float, default=60.0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, default=PROJECT / "build" / "neural.npz")
    options = parser.parse_args()
    rng, begun, seconds, lessons = np.random.default_rng(options.seed), time.monotonic(), 60 * options.minutes, []
    while time.monotonic() - begun < DRAWING * seconds:
        lessons.append(lesson(rng, OWN, SHARED))
    apart = len(lessons) // 20
    w, steps = trained(by_size(lessons[apart:]), seconds - (time.monotonic() - begun), rng)
    loss, prior = held_out(w, lessons[:apart], rng)
    facts = {
        "minutes": options.minutes,
        "processor_minutes": time.process_time() / 60,
        "sessions": len(lessons) - apart,
    }
    facts |= {"draws": steps * DESIGNS * DRAWS, "loss": loss, "prior_loss": prior}
    print(facts)
    options.out.parent.mkdir(exist_ok=True)
    np.savez(options.out, own=OWN, shared=SHARED, **w, **facts)


if __name__ == "__main__":
    main()
