"""Samples far from all others of their rest, which its mean is to be taken without.

A sample is wild by its distance from the median in median deviations (Hampel 1974, J. Am. Stat. Assoc. 69, 383): six
standard deviations, where Gaussian noise has one in five hundred million, so that the mean loses nothing. What lasts
for more than a few samples is a motion or a course, and no stray reading.
"""

import numpy as np
from numpy.typing import NDArray

from estimator.screening.samples import smallest_step
from estimator.session import Array

FAR = 6.0
"""Standard deviations, or steps of a coarse sensor, from the median of the rest."""
SUSPECT = 5.0
"""Standard deviations of all samples, wild ones among them, from which the median is looked at: up to one sample in
twenty-five raises the largest beyond."""
FEW = 3
"""Samples in a row that may be stray: a knock lasts longer."""
RARE = 0.1
"""Part of a rest that may be: more is how the sensor reads."""
FEWEST = 16
"""Samples whose median deviation means anything."""
SOME = 128
"""Samples that tell the standard deviation to 6 %, which is near enough to look closer or not."""
OF_NORMAL = 1.4826
"""Standard deviation in median deviations, of normal noise."""


BLOCK = 1024
"""Samples of a rest that are looked at together, from its start on: in a log that comes in parts, too."""


def without_wild(rest: Array) -> NDArray[np.bool_] | None:
    """(n, m) wild samples of a rest (n, m), any unit, NaN where one is left out already; None where there is none."""
    blocks = [rest[at : at + BLOCK] for at in range(0, len(rest), BLOCK)]
    found = [_of_block(block) for block in blocks]
    if all(wild is None for wild in found):
        return None
    whole = (np.zeros(b.shape, bool) if wild is None else wild for b, wild in zip(blocks, found, strict=True))
    return np.concatenate(list(whole))


def _of_block(rest: Array) -> NDArray[np.bool_] | None:
    if len(rest) < FEWEST:
        return None
    some = rest[:: max(len(rest) // SOME, 1)]
    middle, spread = some.mean(axis=0), some.std(axis=0)
    span = np.maximum(rest.max(axis=0) - middle, middle - rest.min(axis=0))
    suspects = np.flatnonzero(~(span <= SUSPECT * spread))
    found = np.zeros(rest.shape, dtype=bool)
    for i in suspects.tolist():
        found[:, i] = _stray(rest[:, i])
    return found if found.any() else None


def _stray(x: Array) -> NDArray[np.bool_]:
    """(n,) whether each reading of one channel x (n,) is wild."""
    rows = np.flatnonzero(np.isfinite(x))
    if len(rows) < FEWEST:
        return np.zeros(len(x), dtype=bool)
    away = np.abs(x[rows] - np.median(x[rows]))
    far = away > FAR * max(OF_NORMAL * float(np.median(away)), smallest_step(x[rows]))
    edges = np.flatnonzero(np.diff(np.concatenate([[False], far, [False]]).astype(np.int8)))
    for start, stop in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True):
        if stop - start > FEW:
            far[start:stop] = False
    found = np.zeros(len(x), dtype=bool)
    if np.count_nonzero(far) <= RARE * len(rows):
        found[rows[far]] = True
    return found
