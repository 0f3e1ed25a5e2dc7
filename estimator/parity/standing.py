"""Sensors that stand still while they ought not to: dead ones, known by their raw readings alone.

Theory
------
A reading that never changes through whole blocks is a sound one's where the noise is finer than its step and nothing
moves. It is a dead one's

* where its noise is not so fine: samples with noise of half a step or more read the same as the one before with a
  chance that the live blocks show, so a run of n of them has the chance eⁿ; of a sensor that never changes the others
  show it; or
* where the other sensors say that what it feels moved by more than two steps meanwhile.

Exactly zero is called zero; a value beyond all that it read alive and that was applied is the end of its range.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.parity.ledger import Blocks, Ledger
from estimator.parity.reference import LEAST_VISIBLE
from estimator.parity.results import FULL_SCALE, INTERMITTENT, STUCK, ZERO
from estimator.session import Array

COARSE = 0.5
"""Steps; noise from which on a reading cannot stand by itself, wherever between two steps its mean lies."""
QUIET = 0.2
"""Part of the live blocks that is taken for the quietest, whose noise counts."""
MOVED = 2.0
"""Steps that the others must have seen it move."""
ERRORS = 6.0
"""Standard errors of what the others say, that their movement must exceed: none in a million blocks by chance."""
LEAST_CHANCE = 1e-6
"""Chance of a run in a sound sensor, in any block of any recording, below which it is dead."""
BEYOND = 1.2
"""Times what was applied at most that the end of a range lies at, at least: a reading that froze lies within."""
SELDOM = 0.9
"""Share of the samples that repeat the one before, up to which the other sensors count as live."""
LIVE = 5
"""Live blocks from which on they show a sensor's noise."""


@dataclass(frozen=True)
class Standing:
    """A sensor that stands still from one block to another."""

    sensor: int
    kind: str
    first: int
    """Block; the first that is wholly so."""
    until: int
    """The block after the last."""
    before: float
    """Share of the block before that it stood already."""
    p_value: float


def standing(ledger: Ledger) -> list[Standing]:
    """Every dead sensor of a recording, one answer each; one that died more than once comes and goes."""
    blocks = ledger.blocks()
    found: list[Standing] = []
    if ledger.averaged or len(blocks) < LIVE:
        return found
    same = blocks.lowest == blocks.highest
    moved = ledger.reference.others(blocks.mean)
    for i in range(same.shape[1]):
        runs = [
            run
            for run in runs_of(same[:, i])
            if not cut_off(ledger, blocks, moved, i, *run)
            and chance(ledger, blocks, same, moved, i, *run) < LEAST_CHANCE
        ]
        if runs:
            found.append(_answer(ledger, blocks, moved, i, runs, same))
    return found


def runs_of(marks: Array) -> Iterator[tuple[int, int]]:
    """First and one after the last of every run of true marks (B,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[0], marks.astype(np.int8), [0]])))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)


def cut_off(ledger: Ledger, blocks: Blocks, moved: Array, i: int, first: int, until: int) -> bool:
    """Whether sensor i stands at its outermost reading while the others show that it is driven beyond: it is then
    sound, and its range too small.
    """
    top, bottom, reading = blocks.highest[:, i].max(), blocks.lowest[:, i].min(), blocks.lowest[first, i]
    outward = float(reading == top) - float(reading == bottom)
    outward *= float(np.sign(ledger.reference.scale[i]))
    beyond = outward * (moved[first:until, i] - blocks.mean[first, i])
    return bool(outward and (beyond > -error_of(ledger, blocks, i)).all() and np.median(beyond) > 0)


def error_of(ledger: Ledger, blocks: Blocks, i: int) -> float:
    """Largest error of the others' estimate of sensor i in a block, m/s² (rad/s): `ERRORS` standard errors."""
    flutter = np.median(blocks.flutter[:, i] / blocks.samples)
    return float(ERRORS * np.sqrt(flutter) / max(ledger.reference.visible[i], LEAST_VISIBLE))


def chance(ledger: Ledger, blocks: Blocks, same: Array, moved: Array, i: int, first: int, until: int) -> float:
    """Largest chance that a sound sensor i stands still in the blocks from ``first`` to ``until``."""
    reference, run = ledger.reference, slice(first, until)
    live = ~same[:, i]
    step = ledger.quantum[i] if np.isfinite(ledger.quantum[i]) else 0.0
    if live.sum() >= LIVE:
        noise = np.sqrt(np.quantile(blocks.jitter[live, i], QUIET)) * abs(reference.scale[i])
        stays = float(np.quantile(blocks.standing[live, i], 1 - QUIET))
        if noise >= COARSE * step and stays < 1.0:
            return float(max(stays, 1e-3) ** blocks.samples[run].sum())
    elif not live.any():
        stays = float(np.median(np.delete(blocks.standing.mean(axis=0), i)))
        if stays < SELDOM:
            return float(max(stays, 1e-3) ** blocks.samples.sum())
    seen = float(np.ptp(moved[run, i]))
    return 0.0 if seen > MOVED * step / abs(reference.scale[i]) + error_of(ledger, blocks, i) else 1.0


def _answer(ledger: Ledger, blocks: Blocks, moved: Array, i: int, runs: list[tuple[int, int]], same: Array) -> Standing:
    first, until = runs[0][0], runs[-1][1]
    before = 0.0
    if first > 0:
        usual = np.median(blocks.standing[~same[:, i], i])
        before = float(np.clip((blocks.standing[first - 1, i] - usual) / max(1 - usual, 1e-6), 0.0, 1.0))
    kind = INTERMITTENT if len(runs) > 1 else _kind(ledger, blocks, moved, i, first, until)
    return Standing(i, kind, first, until, before, LEAST_CHANCE)


def _kind(ledger: Ledger, blocks: Blocks, moved: Array, i: int, first: int, until: int) -> str:
    reading, felt = blocks.lowest[first, i], blocks.mean[first, i]
    if reading == 0.0:
        return ZERO
    alive = np.delete(np.arange(len(blocks)), np.arange(max(first - 1, 0), min(until + 1, len(blocks))))
    applied = np.abs(moved[:, i]).max()
    within = len(alive) and blocks.lowest[alive, i].min() <= reading <= blocks.highest[alive, i].max()
    return STUCK if within or abs(felt) < BEYOND * applied else FULL_SCALE
