"""The measurement that would tell rivals apart, and how many sessions of it."""

from dataclasses import dataclass

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.diagnosis.explanation.next_measurement import other_schedules
from estimator.diagnosis.explanation.rivals import DISTINGUISHED
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.findings import PooledEffect
from estimator.groups.layout import EVERY
from estimator.groups.pool import GroupHypothesis
from estimator.groups.statistics import Block
from estimator.least_squares import least_squares
from estimator.session import Array, CalibrationSession

MOST = 60
"""Sessions beyond which nobody would wait for an answer: five years of one a month."""

AGAIN = "more sessions of the same programme"

OTHER_STAND = "measure one of these units on another stand, and another unit on this one"


@dataclass(frozen=True)
class Separator:
    """Plans measurements from the sessions of a group, where they are at hand."""

    sessions: tuple[CalibrationSession, ...]

    def measurements(self, effect: PooledEffect) -> list[tuple[str, int | None]]:
        """The measurement that would separate each rival of a finding, in words, and the number of such sessions."""
        if not effect.rivals or not self.sessions:
            return [("", None)] * len(effect.rivals)
        h, amplitude = effect.hypothesis, effect.mean.value
        plans = planned(self.session_of(h))
        answers: list[tuple[str, int | None]] = []
        for rival in effect.rivals:
            if rival.hypothesis.cause == h.cause:
                answers.append((OTHER_STAND, None))
                continue
            missing = DISTINGUISHED**2 - rival.separation**2
            gains = [(plan.words, plan.apart(h, rival.hypothesis, amplitude)) for plan in plans]
            words, best = max(gains, key=lambda g: g[1], default=("", 0.0))
            count = int(np.ceil(missing / best)) if best > 0 and missing / best <= MOST else None
            answers.append((words if count else "", count))
        return answers

    def session_of(self, h: GroupHypothesis) -> CalibrationSession:
        """The latest session that a hypothesis speaks of."""
        known = [s for s in self.sessions if h.subject in s.subjects]
        return known[-1] if known else self.sessions[-1]


@dataclass(frozen=True, eq=False)
class SeparationPlan:
    """A session that could be measured."""

    words: str
    residuals: WhitenedResiduals
    columns: tuple[tuple[Block, Array], ...]

    @classmethod
    def of(cls, words: str, baseline: Baseline) -> "SeparationPlan":
        """The plan with the columns of every candidate."""
        return cls(words, WhitenedResiduals.of(baseline), tuple(columns_of(baseline)))

    def trace(self, h: GroupHypothesis) -> Array | None:
        """(N, w) standard errors per unit amplitude that a hypothesis leaves; None where it cannot show."""
        columns = [
            c
            for b, c in self.columns
            if (b.cause, b.shape) == (h.cause, h.shape) and (h.sensor == b.sensor or (h.sensor == EVERY and b.sensor))
        ]
        return self.residuals.trace(np.sum(columns, axis=0)) if columns else None

    def apart(self, h: GroupHypothesis, rival: GroupHypothesis, amplitude: Array) -> float:
        """Squared separation of a finding at its amplitude from its rival that one such session brings."""
        trace, other = self.trace(h), self.trace(rival)
        if trace is None:
            return 0.0
        signature = trace @ amplitude
        if other is None:
            return float(signature @ signature)
        return float(least_squares(other, signature).chi2)


def planned(session: CalibrationSession) -> list[SeparationPlan]:
    """Plans of the same session again and of every proposal of another one; sessions that are many anyway are not
    averaged too.
    """
    baseline = baseline_of(averaged(session))
    return [
        SeparationPlan.of(AGAIN, baseline),
        *(SeparationPlan.of(words, b) for words, b in other_schedules(baseline)),
    ]
