"""Error rates of `estimator.readiness`: `python -m benchmarks.readiness` prints the tables of its page.

Courses are made here, of nothing that the estimator knows: settling by one and by two time constants, heat that
diffuses into a slab, a steady drift, a swing, a random walk, flicker noise of many relaxations. Sizes are drawn evenly
on a logarithmic scale from a tenth to thirty times what is allowed; what is true is looked up in the course itself.
"""

import argparse
from collections import Counter
from collections.abc import Callable

import numpy as np
from scipy.special import erfc
from scipy.stats import beta as beta_distribution

from estimator.readiness import Allowed, Question, ReadinessState, readiness
from estimator.session import ACCELEROMETER, ARBITRARY_ORIENTATIONS, Array, CalibrationSession
from service.demo.blocks import ACCELEROMETER_SCALE, MICRO_G, sensors_of

SEED = 20_260_314
SENSORS = 4
PERIOD = 10.0
"""s between rows."""
DURATION = 96 * 60.0
"""s of the programme."""
TOLERANCE = 50.0
"""µg."""
MINUTES = (10, 20, 40, 80)
"""Lengths of record, minutes."""
G = 9.80665

Draw = Callable[[Array, np.random.Generator], Array]


def _size(rng: np.random.Generator) -> float:
    return float(TOLERANCE / 4 * np.exp(rng.uniform(np.log(0.1), np.log(30))) * rng.choice([-1, 1]))


def still(t: Array, rng: np.random.Generator) -> Array:
    """A course of zero: white noise alone."""
    return np.zeros_like(t)


def one_settling(t: Array, rng: np.random.Generator) -> Array:
    """A body of one heat capacity, switched on some while ago."""
    tau = np.exp(rng.uniform(np.log(120), np.log(7200)))
    return np.asarray(_size(rng) * (1 - np.exp(-t / tau)))


def two_settlings(t: Array, rng: np.random.Generator) -> Array:
    """Electronics and housing."""
    fast, slow = np.exp(rng.uniform(np.log(60), np.log(600))), np.exp(rng.uniform(np.log(1500), np.log(9000)))
    return np.asarray(_size(rng) * (1 - np.exp(-t / fast)) + _size(rng) * (1 - np.exp(-t / slow)))


def diffusion(t: Array, rng: np.random.Generator) -> Array:
    """Heat that comes through a slab: nothing at first, then all at once, with a long tail."""
    delay = np.exp(rng.uniform(np.log(60), np.log(1800)))
    return np.asarray(_size(rng) * erfc(np.sqrt(delay / np.maximum(t, 1.0))))


def ramp(t: Array, rng: np.random.Generator) -> Array:
    """The room grows warmer."""
    return np.asarray(_size(rng) * t / DURATION)


def swing(t: Array, rng: np.random.Generator) -> Array:
    """An air conditioning that comes and goes, a quarter of an hour to two hours a turn."""
    period = np.exp(rng.uniform(np.log(900), np.log(7200)))
    return np.asarray(0.3 * _size(rng) * np.sin(2 * np.pi * (t / period + rng.uniform())))


def walk(t: Array, rng: np.random.Generator) -> Array:
    """A random walk."""
    steps = rng.standard_normal(len(t)) * np.sqrt(PERIOD / DURATION)
    return np.asarray(0.3 * _size(rng) * np.cumsum(steps))


def flicker(t: Array, rng: np.random.Generator) -> Array:
    """Relaxations of a decade's spacing, of one strength: 1/f over the times that matter."""
    total, strength = np.zeros_like(t), 0.1 * _size(rng)
    for tau in 10.0 * 3.0 ** np.arange(8):
        keep = np.exp(-PERIOD / tau)
        noise, state = rng.standard_normal(len(t)) * np.sqrt(1 - keep**2), rng.standard_normal()
        for k in range(len(t)):
            state = keep * state + noise[k]
            total[k] += strength * state
    return total


COURSES: dict[str, Draw] = {
    "white noise alone": still,
    "one time constant": one_settling,
    "two time constants": two_settlings,
    "diffusion": diffusion,
    "steady drift": ramp,
    "swing": swing,
    "random walk": walk,
    "flicker noise": flicker,
}


def case(draw: Draw, minutes: int, rng: np.random.Generator) -> tuple[ReadinessState, bool]:
    """The answer to one case, and whether the drift to come exceeds what is allowed."""
    count = int(60 * minutes / PERIOD)
    t = PERIOD * np.arange(count + int(DURATION / PERIOD) + 1) + rng.uniform(0, 3600)
    course = np.stack([draw(t, rng) for _ in range(SENSORS)], axis=1)
    white = np.exp(rng.uniform(np.log(0.3), np.log(5.0)))
    sensors = sensors_of(ACCELEROMETER, SENSORS)
    force = np.stack([s.nominal_axis for s in sensors]) @ np.array([0.0, G, 0.0])
    read = force + MICRO_G * (course + white * rng.standard_normal(course.shape))[:count]
    session = CalibrationSession(
        unit="simulated", block=ACCELEROMETER, programme=ARBITRARY_ORIENTATIONS, sensors=sensors,
        readings=ACCELEROMETER_SCALE * read, standard_errors=np.full(read.shape, np.nan), time=t[:count] - t[0],
    )  # fmt: skip
    question = Question({ACCELEROMETER: Allowed(TOLERANCE * MICRO_G, 100e-6, 20e-6 / G)}, DURATION)
    answer = readiness(session, question, np.random.default_rng(1)).state
    to_come = np.abs(course[count:] - course[count - 1]).max(axis=0)
    return answer, bool((to_come > TOLERANCE / 4).any())


def interval(hits: int, of: int) -> str:
    """``3/120 = 2.5 % (0.5 to 7.1)``: Clopper and Pearson's, 95 %."""
    if not of:
        return "–"
    low = beta_distribution.ppf(0.025, hits, of - hits + 1) if hits else 0.0
    high = beta_distribution.ppf(0.975, hits + 1, of - hits) if hits < of else 1.0
    return f"{hits}/{of} = {100 * hits / of:.1f} % ({100 * low:.1f} to {100 * high:.1f})"


def main() -> None:
    """Prints the tables."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--cases", type=int, default=60, help="of each course and length")
    options.add_argument("--seed", type=int, default=SEED)
    chosen = options.parse_args()
    headings = (
        "course",
        "ready, and exceeds",
        "not ready, and does not exceed",
        "ready, of what does not",
        "too early",
    )
    made = f"python -m benchmarks.readiness --cases {chosen.cases} --seed {chosen.seed}"
    print(f"# Readiness: how often it is wrong\n\nPrinted by `{made}`; 95 % intervals (Clopper and Pearson).\n")
    print(f"| {' | '.join(headings)} |")
    print("| --- | --- | --- | --- | --- |")
    total: Counter[tuple[ReadinessState, bool]] = Counter()
    for number, (name, draw) in enumerate(COURSES.items()):
        rng = np.random.default_rng([chosen.seed, number])
        counts = Counter(case(draw, minutes, rng) for minutes in MINUTES for _ in range(chosen.cases))
        print(_row(name, counts), flush=True)
        total += counts
    print(_row("**all**", total))


def _row(name: str, counts: Counter[tuple[ReadinessState, bool]]) -> str:
    late, fine = (sum(n for (_, far), n in counts.items() if far == of) for of in (True, False))
    refused = counts[ReadinessState.NOT_WARM, False] + counts[ReadinessState.NOT_STILL, False]
    early = sum(n for (state, _), n in counts.items() if state is ReadinessState.TOO_EARLY)
    cells = (
        interval(counts[ReadinessState.READY, True], late),
        interval(refused, fine),
        interval(counts[ReadinessState.READY, False], fine),
        interval(early, late + fine),
    )
    return f"| {name} | {' | '.join(cells)} |"


if __name__ == "__main__":
    main()
