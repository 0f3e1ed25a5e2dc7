"""The measurement that would tell rivals apart, and how many sessions of it."""

from dataclasses import dataclass

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.diagnosis.explanation.next_measurement import proposals
from estimator.diagnosis.explanation.rivals import DISTINGUISHED
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.findings import Told
from estimator.groups.layout import EVERY, Hypothesis
from estimator.groups.selection import Selection
from estimator.session import Array, CalibrationSession

MOST = 1000
"""Sessions beyond which nobody would wait for an answer."""

OTHER_STAND = "measure one of these units on another stand, and another unit on this one"


@dataclass(frozen=True)
class Separator:
    """Plans measurements from the sessions of a group, where they are at hand."""

    sessions: tuple[CalibrationSession, ...]

    def measurements(self, selection: Selection, one: Told) -> list[tuple[str, int | None]]:
        """For every rival of a finding: what to measure, in words, and how many sessions of it."""
        if not one.rivals or not self.sessions:
            return [("", None)] * len(one.rivals)
        h, amplitude = one.found.hypothesis, one.mean.value
        plans = planned(self.session_of(h))
        answers: list[tuple[str, int | None]] = []
        for rival in one.rivals:
            if rival.hypothesis.cause == h.cause:
                answers.append((OTHER_STAND, None))
                continue
            missing = DISTINGUISHED**2 - rival.separation**2
            gains = [(words, information_apart(b, h, rival.hypothesis, amplitude)) for words, b in plans]
            words, best = max(gains, key=lambda g: g[1], default=("", 0.0))
            count = int(np.ceil(missing / best)) if best > 0 and missing / best <= MOST else None
            answers.append((words if count else "", count))
        return answers

    def session_of(self, h: Hypothesis) -> CalibrationSession:
        """The latest session that a hypothesis speaks of."""
        known = [s for s in self.sessions if h.subject in (s.unit, s.unit_type, s.stand.id if s.stand else "")]
        return known[-1] if known else self.sessions[-1]


def planned(session: CalibrationSession) -> list[tuple[str, Baseline]]:
    """The same session again, and every proposal of another one."""
    baseline = baseline_of(averaged(session))
    return [("more sessions of the same programme", baseline), *proposals(baseline)]


def information_apart(baseline: Baseline, h: Hypothesis, rival: Hypothesis, amplitude: Array) -> float:
    """Squared separation of a finding from its rival that one planned session brings."""
    residuals, columns = WhitenedResiduals.of(baseline), list(columns_of(baseline))
    own, other = (
        [c for b, c in columns if (b.cause, b.shape) == (x.cause, x.shape) and x.sensor in (b.sensor, EVERY)]
        for x in (h, rival)
    )
    if not own:
        return 0.0
    signature = residuals.trace(np.sum(own, axis=0)) @ amplitude
    if not other:
        return float(signature @ signature)
    trace = residuals.trace(np.sum(other, axis=0))
    scale = np.maximum(np.linalg.norm(trace, axis=0), 1e-300)
    value, *_ = np.linalg.lstsq(trace / scale, signature, rcond=1e-9)
    return float(((signature - trace / scale @ value) ** 2).sum())
