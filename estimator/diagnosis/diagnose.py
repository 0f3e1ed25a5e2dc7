"""Show what the simulation gets wrong, name the cause, extend the model, measure the gain.

measured session → baseline simulation → what is left → causes → extended model → gain
"""

from collections.abc import Sequence

import numpy as np

from estimator.calibration.calibrate import averaged, calibrate
from estimator.causes import CATALOGUE, Cause, Correction, Entry
from estimator.diagnosis.explanation.detection_limits import limits
from estimator.diagnosis.explanation.earlier_sessions import newness
from estimator.diagnosis.explanation.extended_model import amplitudes, extended_calibration, without_effects
from estimator.diagnosis.explanation.findings import clip_findings, entry_finding, findings, slip_finding, structures
from estimator.diagnosis.explanation.gain import gain
from estimator.diagnosis.record.clipping import unclipped
from estimator.diagnosis.record.errors import Slip, exchanged_rows, expected_axes, turned_record
from estimator.diagnosis.record.nominal import WrongEntry, wrong_entry
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import parameter_covariance
from estimator.diagnosis.results import Diagnosis
from estimator.diagnosis.selection.refinement import polished
from estimator.diagnosis.selection.search import search
from estimator.diagnosis.selection.search_state import Search, begin
from estimator.session import TWO_AXIS_STAND, CalibrationSession


def diagnose(
    session: CalibrationSession,
    history: Sequence[CalibrationSession] = (),
    *,
    catalogue: Sequence[Cause] = CATALOGUE,
) -> Diagnosis:
    """What the simulation gets wrong about a session.

    Parameters
    ----------
    session : of a programme that calibrates a block.
    history : earlier sessions of the unit, oldest first.
    catalogue : the causes to consider.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all.
    """
    rows = averaged(session)
    clips, whole = unclipped(rows, catalogue)
    past = [unclipped(averaged(h), catalogue)[1] for h in history]
    slips, right = undo_slips(whole, [baseline_of(h) for h in past], catalogue)
    state = searched(right, past, catalogue)
    entry = None if past else against_nominal(without_effects(state, amplitudes(state)), catalogue)
    if entry is not None:
        state = searched(entry.corrected(right), past, catalogue)
    fitted = amplitudes(state)
    new = newness(state, fitted)
    return Diagnosis(
        unit=session.unit,
        findings=(
            *clip_findings(clips, rows, state.baseline),
            *(slip_finding(s, rows) for s in slips),
            *([] if entry is None else [entry_finding(entry)]),
            *findings(state, fitted, new),
        ),
        structures=structures(state),
        gain=gain(state, baseline_of(rows) if clips or slips else None, fitted, new),
        limits=limits(state, catalogue),
        baseline=calibrate(rows),
        calibration=extended_calibration(state, fitted),
    )


def searched(session: CalibrationSession, history: Sequence[CalibrationSession], catalogue: Sequence[Cause]) -> Search:
    """The search for causes in a session whose record is right."""
    baseline, earlier = common_start(session, history)
    return polished(search(begin(baseline, earlier, catalogue)))


def against_nominal(session: CalibrationSession, catalogue: Sequence[Cause]) -> WrongEntry | None:
    """A wrong entry told from the nominal axes of a session freed of its effects; None where there is none."""
    entry = next((c for c in catalogue if isinstance(c, Entry)), None)
    if entry is None or session.programme != TWO_AXIS_STAND:
        return None
    return wrong_entry(session, entry)


def common_start(session: CalibrationSession, history: Sequence[CalibrationSession]) -> tuple[Baseline, list[Baseline]]:
    """Baselines of a session and its history, taken near one another.

    What one of them does not observe (a single run leaves a direction open) would else stay at different values, far
    enough apart for the second order to show as a move of what is observed.
    """
    baseline = baseline_of(session)
    earlier = [baseline_of(h) for h in history]
    if session.programme != TWO_AXIS_STAND or not earlier:
        return baseline, earlier
    best = min([baseline, *earlier], key=lambda b: float(np.trace(parameter_covariance(b))))
    start = best.parameters
    return baseline_of(session, start), [baseline_of(h, start) for h in history]


def undo_slips(
    session: CalibrationSession, history: Sequence[Baseline], catalogue: Sequence[Cause]
) -> tuple[list[Slip], CalibrationSession]:
    """Put the record right where it is plainly wrong: the slips and the session put right."""
    known = [c for c in catalogue if isinstance(c, Correction)]
    slips: list[Slip] = []
    baseline = baseline_of(session)
    for _ in range(3):
        slip = turned_record(session, baseline, expected_axes(history, session), known)
        slip = slip or exchanged_rows(baseline, known)
        if slip is None:
            break
        slips.append(slip)
        session = slip.session
        baseline = baseline_of(session)
    return [s for s in slips if not undone(s, slips)], session


def undone(slip: Slip, slips: Sequence[Slip]) -> bool:
    """Whether a slip was put right and then back again, because another one had misled the first look."""
    same = [s for s in slips if (s.cause, s.places) == (slip.cause, slip.places)]
    return len(same) % 2 == 0
