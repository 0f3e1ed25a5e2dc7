"""Positions, order, time and temperature of a session."""

from dataclasses import dataclass

import numpy as np

from tests.blind.world import Array, Schedule


@dataclass(frozen=True)
class Wanted:
    """Requirements on a schedule."""

    positions: int
    runs: tuple[bool, ...]
    """Flipped or not, in the order measured."""
    equal: bool
    shuffled: bool
    profile: str
    timed: bool
    thermometer: bool

    @staticmethod
    def drawn(rng: np.random.Generator, needs: frozenset[str], *, one_run: float, most: int) -> "Wanted":
        """Anything that satisfies the needs."""
        runs: tuple[bool, ...] = (False, True) if rng.random() < 0.8 else (True, False)
        if rng.random() < one_run and "both runs" not in needs:
            runs = runs[:1]
        positions = int(rng.integers(8, most + 1)) if len(runs) == 2 else int(rng.integers(14, most + 9))
        thermal = "temperature" in needs
        profiles = ["ramp", "cycle", "settling", "wander"] + ([] if thermal else ["constant"])
        return Wanted(
            positions=positions,
            runs=runs,
            equal=bool(rng.random() < 0.7),
            shuffled=bool(rng.random() < 0.35),
            profile=str(rng.choice(profiles)),
            timed=bool("time" in needs or rng.random() < 0.85),
            thermometer=bool(thermal or rng.random() < 0.7),
        )


def draw_beta(wanted: Wanted, rng: np.random.Generator) -> Array:
    """(N,) rad, of one run: equal steps over the whole circle, or jittered with a gap, in order or shuffled."""
    N = wanted.positions
    beta = 2 * np.pi * np.arange(N) / N
    if not wanted.equal:
        beta = np.sort(np.mod(beta + rng.uniform(-0.45, 0.45, N) * 2 * np.pi / N, 2 * np.pi))
        beta = np.radians(np.round(np.degrees(beta), 1))
    return rng.permutation(beta) if wanted.shuffled else beta


def draw_profile(name: str, time: Array, rng: np.random.Generator) -> tuple[Array, Array]:
    """Temperature (R,), °C, and its rate (R,), °C/s, at times (R,), s: smooth on the scale of a few rows."""
    span = time[-1] - time[0]
    start, swing = rng.uniform(15, 30), rng.uniform(1.5, 12) * rng.choice([-1, 1])
    if name == "constant":
        return start + 0 * time, 0 * time
    if name == "ramp":
        return start + swing * time / span, swing / span + 0 * time
    if name == "settling":
        tau = span * rng.uniform(0.15, 0.6)
        gone = np.exp(-time / tau)
        return start + swing * (1 - gone), swing / tau * gone
    waves = 1 if name == "cycle" else 3
    temperature, rate = np.full(len(time), start), np.zeros(len(time))
    for _ in range(waves):
        period = span * rng.uniform(0.3, 1.5)
        phase, size = rng.uniform(0, 2 * np.pi), swing * rng.uniform(0.3, 1.0)
        turn = 2 * np.pi * time / period + phase
        temperature += size * np.sin(turn)
        rate += size * 2 * np.pi / period * np.cos(turn)
    return temperature, rate


def draw_schedule(wanted: Wanted, rng: np.random.Generator) -> Schedule:
    """Rows run after run, a re-fixturing break between them."""
    per_run = [draw_beta(wanted, rng) for _ in wanted.runs]
    beta = np.concatenate(per_run)
    flipped = np.repeat(np.array(wanted.runs), wanted.positions)
    steps = rng.uniform(60, 300) * rng.uniform(0.8, 1.25, len(beta))
    steps[0] = 0.0
    steps[wanted.positions :: wanted.positions] += rng.uniform(300, 3600)
    time = np.round(np.cumsum(steps), 1)
    temperature, rate = draw_profile(wanted.profile, time, rng)
    return Schedule(
        flipped=flipped,
        beta=beta,
        time=time,
        temperature=np.round(temperature, 4),
        temperature_rate=rate,
        timed=wanted.timed,
        thermometer=wanted.thermometer,
    )
