"""What histories tell of their type, as bytes and back: a row a history of its years and its log evidence, float32."""

from collections.abc import Sequence

import numpy as np

from estimator.health.fits import PARTS, WALKS
from estimator.health.pooled import Evidence

SHAPE = (len(WALKS), len(PARTS))
"""Of the log evidence of one history."""


def packed(histories: Sequence[Evidence]) -> bytes:
    """What `unpacked` reads; log evidence relative to its largest, which is all that is learned from."""
    rows = [np.append(h.span, h.log_evidence - h.log_evidence.max()) for h in histories]
    return np.asarray(rows, dtype="<f4").tobytes()


def unpacked(content: bytes) -> tuple[Evidence, ...]:
    """The histories that were written."""
    rows = np.frombuffer(content, dtype="<f4").astype(float).reshape(-1, 1 + SHAPE[0] * SHAPE[1])
    return tuple(Evidence(float(row[0]), row[1:].reshape(SHAPE)) for row in rows)
