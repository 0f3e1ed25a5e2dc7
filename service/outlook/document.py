"""Outlooks and histories as they are kept.

errors and its log evidence, float32, behind a mark.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from estimator.health.error_laws import FREEDOMS
from estimator.health.fits import PART_KINDS, PARTS, WALKS
from estimator.health.pooled import Evidence
from estimator.health.shapes import Kind
from service.outlook.records import UnitOutlook
from service.storage.documents import STORED


def outlook_to_dicts(outlook: UnitOutlook) -> tuple[dict[str, Any], dict[str, Any]]:
    """What `outlook_from_dicts` reads; times are ISO 8601."""
    written: dict[str, Any] = STORED.written(outlook)
    fans = [trend.pop("fan") for trend in written["trends"]]
    return written, {"risk": written.pop("risk"), "fans": fans}


def outlook_from_dicts(document: dict[str, Any], drawn: dict[str, Any] | None = None) -> UnitOutlook:
    """The outlook that was written; without its fans and its risk where what is drawn was left in the store."""
    if drawn is None:
        return STORED.read(UnitOutlook, document)
    trends = [trend | {"fan": fan} for trend, fan in zip(document["trends"], drawn["fans"], strict=True)]
    return STORED.read(UnitOutlook, document | {"trends": trends, "risk": drawn["risk"]})


SHAPE = (len(WALKS), len(PARTS))
"""Of the log evidence of one history."""
LAWS = len(FREEDOMS)
MARK = np.full(1, -np.inf, dtype="<f4")
"""Rows behind a positive one were written before temperature was distinguished from drifts; those behind a NaN, which
hold tails, and those behind nothing before aging that comes to an end was distinguished from aging that goes on."""
WARM = int(np.count_nonzero(PART_KINDS == Kind.WARMTH))
EARLIER, EARLIEST = SHAPE[1] - WARM, SHAPE[1] - WARM - 2
"""Parts of the log evidence of those."""


def packed(histories: Sequence[Evidence]) -> bytes:
    """What `unpacked` reads; logs relative to their largest, which is all that is learned from."""
    rows = [np.concatenate([[h.span], h.log_tails, (h.log_evidence - h.log_evidence.max()).ravel()]) for h in histories]
    return MARK.tobytes() + np.asarray(rows, dtype="<f4").tobytes()


def unpacked(content: bytes) -> tuple[Evidence, ...]:
    """The histories that were written."""
    numbers = np.frombuffer(content, dtype="<f4").astype(float)
    is_marked = not np.isfinite(numbers[:1]).all()
    parts = SHAPE[1] if np.isneginf(numbers[:1]).any() else EARLIER if np.isinf(numbers[:1]).any() else EARLIEST
    laws = LAWS if is_marked else 0
    rows = numbers[is_marked:].reshape(-1, 1 + laws + SHAPE[0] * parts)
    tails = rows[:, 1 : 1 + laws] if laws else np.zeros((len(rows), LAWS))
    evidence = rows[:, 1 + laws :].reshape(-1, SHAPE[0], parts)
    if parts == EARLIEST:  # of which end was open: as likely by one as by the other
        evidence = np.concatenate([evidence, evidence[..., -2:]], axis=2)
    if parts != SHAPE[1]:  # of temperature they tell nothing: as likely with it as without
        evidence = np.concatenate([evidence, np.repeat(evidence[..., :1], WARM, axis=2)], axis=2)
    return tuple(
        Evidence(float(row[0]), *own) for row, own in zip(rows, zip(evidence, tails, strict=True), strict=True)
    )
