"""What histories tell of their type, as bytes and back: a row a history of its years, what it tells of the tails of
errors and its log evidence, float32, behind a mark."""

from collections.abc import Sequence

import numpy as np

from estimator.health.error_laws import FREEDOMS
from estimator.health.fits import PARTS, WALKS
from estimator.health.pooled import Evidence

SHAPE = (len(WALKS), len(PARTS))
"""Of the log evidence of one history."""
LAWS = len(FREEDOMS)
MARK = np.full(1, np.nan, dtype="<f4")
"""Rows without it were written before they told of tails."""


def packed(histories: Sequence[Evidence]) -> bytes:
    """What `unpacked` reads; logs relative to their largest, which is all that is learned from."""
    rows = [np.concatenate([[h.span], h.log_tails, (h.log_evidence - h.log_evidence.max()).ravel()]) for h in histories]
    return MARK.tobytes() + np.asarray(rows, dtype="<f4").tobytes()


def unpacked(content: bytes) -> tuple[Evidence, ...]:
    """The histories that were written."""
    numbers = np.frombuffer(content, dtype="<f4").astype(float)
    laws = LAWS if np.isnan(numbers[:1]).any() else 0
    rows = numbers[1 if laws else 0 :].reshape(-1, 1 + laws + SHAPE[0] * SHAPE[1])
    tails = rows[:, 1 : 1 + laws] if laws else np.zeros((len(rows), LAWS))
    evidence = rows[:, 1 + laws :].reshape(-1, *SHAPE)
    return tuple(
        Evidence(float(row[0]), *own) for row, own in zip(rows, zip(evidence, tails, strict=True), strict=True)
    )
