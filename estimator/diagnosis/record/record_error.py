"""A record error: the ways to put the record right that were tried, most likely first."""

from dataclasses import dataclass

import numpy as np
from scipy.special import logsumexp

from estimator.causes.contract import RecordCorrection
from estimator.session import CalibrationSession

BETTER = 10.0
"""ln evidence by which a corrected record must win: odds of 20,000, for a record is altered only where it is plain."""


@dataclass(frozen=True, eq=False)
class RecordAttempt:
    """One way to put a record right."""

    cause: RecordCorrection
    places: tuple[int, ...]
    """Sensors, or rows counted from 0 for exchanged positions."""
    session: CalibrationSession
    """Put right."""
    log_evidence: float
    """ln evidence against the record as it came, the choice among the ways of its cause included."""


@dataclass(frozen=True, eq=False)
class RecordError:
    """A record error found and undone."""

    attempts: tuple[RecordAttempt, ...]
    """Every way tried, most likely first."""

    @property
    def undone(self) -> RecordAttempt:
        """The way it was undone."""
        return self.attempts[0]

    def posterior(self) -> list[tuple[RecordAttempt, float]]:
        """Every way with its share, given that one of them is right."""
        values = np.array([a.log_evidence for a in self.attempts])
        share = np.exp(values - logsumexp(values))
        return [(a, float(p)) for a, p in zip(self.attempts, share, strict=True)]
