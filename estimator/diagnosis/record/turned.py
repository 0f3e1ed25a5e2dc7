"""Record errors that turn axes: signs, channels, runs or angles written down wrong.

Such an error leaves nothing, or far too much, within the session; what shows it is that the fitted axes are far from
those of the unit's history (or the nominal ones), and that putting the record right brings them back.
"""

from collections.abc import Sequence

import numpy as np

from estimator.causes.contract import RecordCorrection
from estimator.diagnosis.record.record_error import BETTER, RecordAttempt, RecordError
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.errors import SessionError
from estimator.session import TWO_AXIS_STAND, Array, CalibrationSession

TELLING = np.radians(2.0)
"""Angle from the expected axis, rad, beyond which the record is suspected: more than axes are mounted or drift off,
far less than any exchange or wrong sign turns them."""

NEARER = 3.0
"""Factor by which a correction must bring the worst axis nearer to be a way at all."""

ALIKE = float(np.log(1.5))
"""ln of a ratio by which scale factors of one kind, each relative to its nominal one, may differ: far more than makers
or ageing allow."""

LEAST = 1e-10
"""rad² an axis, (2 arcsec)²: how well axes agree at best, so that a perfect agreement does not count without bound."""


def turned_record(baseline: Baseline, expected: Array, known: Sequence[RecordCorrection]) -> RecordError | None:
    """The record error that explains axes far from the ``expected`` ones (m, 3), unit vectors; None without one."""
    before, worst = misfit(baseline, expected)
    if worst < TELLING:
        return None
    session, tried = baseline.session, list[RecordAttempt]()
    m = len(session.sensors)
    for cause in known:
        if not cause.between or not usable(cause, session):
            continue
        alternatives = list(cause.corrected(session))
        for places, right in alternatives:
            after, largest = misfit_of(right, expected)
            if largest < worst / NEARER and scales_agree(right):
                floor = max(after, m * LEAST)
                log_evidence = m * float(np.log(before / floor)) - float(np.log(len(alternatives)))
                tried.append(RecordAttempt(cause, places, right, log_evidence))
    tried.sort(key=lambda a: -a.log_evidence)
    return RecordError(tuple(tried)) if tried and tried[0].log_evidence >= BETTER else None


def misfit(baseline: Baseline, expected: Array) -> tuple[float, float]:
    """Sum of squared angles between fitted and ``expected`` axes (m, 3), rad², and the largest, rad."""
    axes = baseline.parameters.axis
    cosine = np.clip((axes * expected).sum(axis=-1), -1.0, 1.0)
    chord = np.linalg.norm(axes - expected, axis=-1)
    angle = np.where(cosine > 0.5, chord, np.arccos(cosine))
    return float((angle**2).sum()), float(angle.max())


def scales_agree(session: CalibrationSession) -> bool:
    """Whether no sensor's scale factor stands far out of its kind, each relative to its nominal one.

    Signs, channels and runs change no scale factor; a sensor that answers with a step as its input changes sign does.
    """
    scale = baseline_of(session).parameters.scale
    off = np.log(np.abs(scale) / [s.nominal_scale for s in session.sensors])
    kinds = np.array([s.kind for s in session.sensors])
    return all(np.ptp(off[kinds == kind]) < ALIKE for kind in set(kinds.tolist()))


def misfit_of(session: CalibrationSession, expected: Array) -> tuple[float, float]:
    """`misfit`, rad² and rad, of a corrected record to axes (m, 3); infinite where it cannot be calibrated at all."""
    try:
        return misfit(baseline_of(session), expected)
    except SessionError:
        return float("inf"), float("inf")


def usable(cause: RecordCorrection, session: CalibrationSession) -> bool:
    """Whether a correction makes sense for the session's programme and runs."""
    if session.programme != TWO_AXIS_STAND:
        return not cause.needs & {"stand", "both runs"}
    has_both_runs = session.flipped is not None and bool(session.flipped.any()) and not bool(session.flipped.all())
    return has_both_runs or "both runs" not in cause.needs


def expected_axes(history: Sequence[Baseline], session: CalibrationSession) -> Array:
    """(m, 3) unit vectors, the axes to expect: those of the latest comparable session, else the nominal ones."""
    names = tuple(s.name for s in session.sensors)
    for earlier in reversed(history):
        if tuple(s.name for s in earlier.session.sensors) == names:
            return earlier.parameters.axis
    return np.stack([s.nominal_axis for s in session.sensors])
