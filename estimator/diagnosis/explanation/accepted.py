"""Calibration under a model that holds accepted causes: their amplitudes are fitted, whatever their significance."""

from collections.abc import Sequence
from dataclasses import replace

from estimator.calibration.calibrate import averaged, calibrate
from estimator.causes.catalogue import cause
from estimator.causes.sensor import ReadingOutlier
from estimator.diagnosis.explanation.extended_model import amplitudes, extended_calibration
from estimator.diagnosis.record.clipping import unclipped
from estimator.diagnosis.residuals.flipped_run import with_its_flip
from estimator.diagnosis.selection.refinement import with_refined_shapes
from estimator.diagnosis.selection.search_state import Detection, SearchState
from estimator.diagnosis.selection.start import begin
from estimator.diagnosis.signatures.scores import score
from estimator.results import Calibration
from estimator.session import CalibrationSession

Accepted = tuple[str, tuple[str, ...]]
"""A cause's identifier and the names of its sensors; none for a cause of the stand or fixture."""


def calibrate_extended(session: CalibrationSession, causes: Sequence[Accepted]) -> Calibration:
    """Calibrate a session under the baseline model extended with accepted causes.

    Parameters
    ----------
    session : of a programme that calibrates a block.
    causes : what was accepted. A cause that the session cannot show (no thermometer, no such sensor) is left out.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all.
    """
    rows = averaged(session)
    known = [cause(identifier) for identifier, _ in causes]
    clips, whole = unclipped(rows, known)
    state = begin(with_its_flip(whole), (), known, patterns=())
    done = {(clip.cause.identifier, (clip.sensor,)) for clip in clips}
    names = [sensor.name for sensor in rows.sensors]
    done |= {(ReadingOutlier.identifier, (names.index(out.sensor),)) for out in rows.set_aside}
    for identifier, sensors in causes:
        for place in places(rows, sensors):
            if (identifier, place) not in done:
                state = with_cause(state, identifier, place)
    if not state.detections:
        return calibrate(whole)
    state = with_refined_shapes(state)
    return extended_calibration(state, amplitudes(state))


def places(session: CalibrationSession, sensors: Sequence[str]) -> list[tuple[int, ...]]:
    """Places of a cause, as in its shapes: sensor by sensor, or one empty place for no sensor in particular."""
    names = [s.name for s in session.sensors]
    return [(names.index(s),) for s in sensors if s in names] if sensors else [()]


def with_cause(state: SearchState, identifier: str, place: tuple[int, ...]) -> SearchState:
    """The state with one more cause, at the nonlinear parameters that fit best beside the others."""
    traces = [t for t in state.traces if t.cause.identifier == identifier]
    scored = [s for s in score(state.residuals, traces, state.attributed()) if s.sensors == place]
    if not scored:
        return state
    best = max(scored, key=lambda s: s.statistic)
    return replace(state, detections=(*state.detections, Detection(best, best.p_value, ())))
