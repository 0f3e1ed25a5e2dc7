"""``python -m benchmarks.study.between_sessions --units 40 --seed 1``: what parameters would add to a unit's group.

A lasting effect of amplitude a leaves X a in a session's whitened residuals, and moves the parameters that are found
there by A a, A = J⁺X: by another amount in every schedule. Residuals and parameters of a fit are independent, so their
information adds up: F = Σ XᵀX of what the calibration does not absorb, and

    G = Aᵀ P A,   P = V⁻¹ − V⁻¹B(BᵀV⁻¹B)⁻¹BᵀV⁻¹,

where A stacks the sessions, V has every session's covariance on its diagonal and the random walk of the parameters
beside it, and B the parameters' common level, their steady drift, and a turn of the block at every mounting: what must
be left open, since units do all of that. Printed is √(1 + G/F), by which the pooled strength would grow, for a walk of
0.3, 1 and 3 standard errors of a session from one session to the next.
"""

import argparse
import os
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import RESULTS
from estimator import read_session
from estimator.arrays import tangents
from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.flipped_run import with_fitted_flip
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.statistics import HARMONIC, Block
from estimator.session import Array
from tests.blind.groups import draw_group

WHOLE = RESULTS / "decisions" / "residuals-alone.md"
HEAD = "# Gain of pooled strength by parameters between sessions"
CELLS = """Factors of the pooled strength, median and in brackets nine in ten; the walk of every parameter between
sessions in standard errors. Level, steady drift and the block's turn at every mounting are free."""
WALKS = (0.3, 1.0, 3.0)
SEEN = 1e-3
"""Share of a signature that a session must leave in its residuals to count: what it absorbs wholly has no strength."""


@dataclass(frozen=True, eq=False)
class Seen:
    """One session: its parameters' covariance (P, P), dimensionless, their axes, and its candidates' columns."""

    residuals: WhitenedResiduals
    covariance: Array
    axes: Array
    columns: dict[Block, Array]


def sessions_of(seed: tuple[int, ...]) -> list[Seen]:
    """The sessions of a unit without an effect, of schedules drawn at random."""
    found = []
    for document in draw_group("unit", "none", seed).sessions:
        baseline = with_fitted_flip(baseline_of(averaged(read_session(document))))
        residuals = WhitenedResiduals.of(baseline)
        covariance = residuals.response @ residuals.response.T
        found.append(Seen(residuals, covariance, baseline.parameters.axis, dict(columns_of(baseline))))
    return found


def growths(sessions: list[Seen]) -> Iterator[tuple[Block, Array]]:
    """Every candidate of all sessions with √(1 + G/F) (3,), one of each walk; of its strongest direction."""
    whitening = [whitened_without(sessions, walk) for walk in WALKS]
    for block in sessions[0].columns:
        if block.cause == HARMONIC or not all(block in s.columns for s in sessions):
            continue
        white = [s.residuals.whitened(s.columns[block]) for s in sessions]
        left = np.concatenate([s.residuals.remaining_of(w) for s, w in zip(sessions, white, strict=True)])
        moved = np.concatenate([s.residuals.response @ w for s, w in zip(sessions, white, strict=True)])
        direction = np.linalg.svd(left, full_matrices=False)[2][0]
        strength = float(np.sum((left @ direction) ** 2))
        if strength > SEEN**2 * float(np.sum((np.concatenate(white) @ direction) ** 2)):
            added = np.array([np.sum((L @ (moved @ direction)) ** 2) for L in whitening])
            yield block, np.sqrt(1 + added / strength)


def whitened_without(sessions: list[Seen], walk: float) -> Array:
    """(N, N) root of P, dimensionless: the parameters of all sessions, N of them, whitened and freed of B."""
    n, size = len(sessions), len(sessions[0].covariance)
    sigma = np.sqrt(np.mean([np.diag(s.covariance) for s in sessions], axis=0))
    order = np.arange(n)
    V = np.kron(np.minimum.outer(order, order), np.diag((walk * sigma) ** 2))
    for k, s in enumerate(sessions):
        own = slice(k * size, (k + 1) * size)
        V[own, own] += s.covariance
    unit = np.diag(sigma)
    level, drift = np.kron(np.ones((n, 1)), unit), np.kron(order[:, None] - n / 2, unit)
    B = np.concatenate([level, drift, turns(sessions, sigma)], axis=1)
    root = np.linalg.inv(np.linalg.cholesky(V))
    left, value, _ = np.linalg.svd(root @ B, full_matrices=False)
    left = left[:, value > 1e-9 * value[0]]
    return np.asarray(root - left @ (left.T @ root))


def turns(sessions: list[Seen], sigma: Array) -> Array:
    """(N, 3 n), in axis sigmas: a turn of the block about each of its axes, at every mounting."""
    n, m = len(sessions), len(sigma) // 5
    B = np.zeros((n, m, 5, n, 3))
    for k, s in enumerate(sessions):
        B[k, :, 3:, k, :] = np.cross(s.axes[:, None, :], np.moveaxis(tangents(s.axes), -1, -2))
    return B.reshape(n * 5 * m, 3 * n) * float(np.median(sigma))


def table(units: int, seed: int) -> Iterator[str]:
    """Lines of the table: a cause a line."""
    found: dict[str, list[Array]] = defaultdict(list)
    for k in range(units):
        for block, growth in growths(sessions_of((seed, 9, k))):
            found[block.cause].append(growth)
    yield "| cause | candidates | walk 0.3 σ | 1 σ | 3 σ |"
    yield "| --- | --- | --- | --- | --- |"
    for cause, every in sorted(found.items(), key=lambda item: -float(np.median([g[1] for g in item[1]]))):
        middle, high = np.quantile(every, [0.5, 0.9], axis=0)
        cells = (f"{a:.2f} ({b:.2f})" for a, b in zip(middle, high, strict=True))
        yield f"| `{cause}` | {len(every)} | {' | '.join(cells)} |"


def main() -> None:
    """Writes the table into its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.between_sessions", description=__doc__)
    parser.add_argument("--units", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    command = f"`python -m benchmarks.study.between_sessions --units {options.units} --seed {options.seed}`"
    lines = list(table(options.units, options.seed))
    WHOLE.parent.mkdir(parents=True, exist_ok=True)
    WHOLE.write_text(f"{HEAD}\n\nMade by {command}. {CELLS}\n\n" + "\n".join(lines) + "\n", encoding="utf-8")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
