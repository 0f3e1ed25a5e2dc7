"""Show what the simulation gets wrong, name the cause, extend the model, measure the gain.

record → residuals → posterior → explanation
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from estimator.calibration.calibrate import as_it_came, averaged, calibrate
from estimator.causes.catalogue import CATALOGUE
from estimator.causes.contract import Cause
from estimator.diagnosis.explanation.detection_limits import limits
from estimator.diagnosis.explanation.earlier_sessions import are_new
from estimator.diagnosis.explanation.extended_model import amplitudes, extended_calibration, without_effects
from estimator.diagnosis.explanation.findings import findings, noise_scales, notes, structures
from estimator.diagnosis.explanation.gain import gain
from estimator.diagnosis.explanation.record_findings import (
    clip_findings,
    doubted_at_one_place,
    entry_finding,
    gross_findings,
    is_beyond_gravity,
    record_error_finding,
    scale_findings,
    wrong_record,
)
from estimator.diagnosis.explanation.temperature import temperatures, with_temperature
from estimator.diagnosis.posterior.explained import ExplainedSession, begin
from estimator.diagnosis.posterior.write import posterior
from estimator.diagnosis.record.clipping import Clip, earlier_baseline, unclipped
from estimator.diagnosis.record.common_scale import CommonScale, is_one_place, on_one_scale
from estimator.diagnosis.record.implausible import ImplausibleAxes, implausible_axes
from estimator.diagnosis.record.nominal import wrong_entry
from estimator.diagnosis.record.record_error import RecordError
from estimator.diagnosis.record.silent import refuse_silent
from estimator.diagnosis.record.turned import expected_axes
from estimator.diagnosis.record.undo import undo_record_errors
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.common_start import about_their_flips, baselines
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.results import Diagnosis
from estimator.diagnosis.settling import beside_history, settling, settling_in, with_open_change
from estimator.diagnosis.turntable import diagnose_alignment
from estimator.session import ROTATION_ALIGNMENT, CalibrationSession


def diagnose(
    session: CalibrationSession,
    history: Sequence[CalibrationSession] = (),
    *,
    catalogue: Sequence[Cause] = CATALOGUE,
) -> Diagnosis:
    """Diagnoses a session from its own readings: the effects that the simulation lacks.

    `estimator.diagnose` adds what only all sessions of the unit together show.

    Parameters
    ----------
    session : of a programme that calibrates a block; of an alignment on a turntable, where lever arms are looked for.
    history : earlier sessions of the unit, oldest first.
    catalogue : the causes to consider.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all, or a channel reads the same in every row.
    """
    if session.programme == ROTATION_ALIGNMENT:
        return diagnose_alignment(session)
    return diagnosed(put_right(session, history, catalogue), catalogue)


@dataclass(frozen=True, eq=False)
class PutRight:
    """A session whose record is corrected, and its history, both fitted."""

    rows: CalibrationSession
    """The session as its file states it, averaged."""
    clips: tuple[Clip, ...]
    errors: tuple[RecordError, ...]
    """Errors of the record that were corrected."""
    right: Baseline
    came: Baseline | None
    """The session as it came, fitted; None where nothing was corrected or set aside."""
    earlier: tuple[Baseline, ...]
    """The history, oldest first, without clipped readings, on the scale of the session."""
    scales: tuple[CommonScale, ...]
    """Common changes of all scale factors since the history, beyond the reach of the applied vector."""


def put_right(
    session: CalibrationSession, history: Sequence[CalibrationSession], catalogue: Sequence[Cause]
) -> PutRight:
    """The session and its history fitted, the session's record corrected first."""
    rows = averaged(session)
    refuse_silent(rows)
    clips, whole = unclipped(rows, catalogue)
    earlier = tuple(earlier_baseline(switched_on_like(h, session), tuple(catalogue)) for h in history)
    errors, right = undo_record_errors(baseline_of(whole), earlier, catalogue)
    scales, earlier = on_one_scale(right, earlier, tuple(catalogue))
    came = baseline_of(as_it_came(session)) if clips or errors or rows.set_aside else None
    return PutRight(rows, tuple(clips), tuple(errors), right, came, earlier, scales)


def switched_on_like(earlier: CalibrationSession, session: CalibrationSession) -> CalibrationSession:
    """An earlier session whose amplitudes count from the same moment as this one's: where it does not say when the unit
    was switched on, as long before as in this one; where this one does not, from its clock."""
    since = session.time_since_power_on
    if (since is None) == (earlier.switched_on is None):
        return earlier
    first = 0.0 if earlier.time is None else float(earlier.time[0])
    return replace(earlier, switched_on=None if since is None else first - since)


def diagnosed(session: PutRight, catalogue: Sequence[Cause]) -> Diagnosis:
    """Diagnoses a session whose record is corrected.

    What looks like gravity and cannot be is a factor of all sensors: the history is then brought to their scale.
    """
    found = diagnosed_so(session, catalogue)
    if not any(map(is_beyond_gravity, found.findings)):
        return found
    scales, earlier = on_one_scale(session.right, session.earlier, tuple(catalogue), least=0.0)
    return diagnosed_so(replace(session, scales=scales, earlier=earlier), catalogue) if scales else found


def diagnosed_so(session: PutRight, catalogue: Sequence[Cause]) -> Diagnosis:
    """Diagnoses a session whose record is corrected, with the history as it is."""
    rows, right, earlier = session.rows, session.right, session.earlier
    wrong = impossible_axes(right, earlier, catalogue)
    state = initial_state(right, earlier, catalogue) if wrong else searched(right, earlier, catalogue)
    entry = None if earlier or wrong else wrong_entry(without_effects(state, amplitudes(state)), catalogue)
    if entry is not None:
        state = searched(baseline_of(entry.corrected(right.session)), earlier, catalogue)
    fitted = amplitudes(state)
    new = are_new(state, fitted)
    calibration = extended_calibration(state, fitted)
    changes = (*scale_findings(session.scales, right.session), *findings(state, fitted, new))
    if is_one_place(right, earlier):
        changes = tuple(map(doubted_at_one_place, changes))
    warmth = temperatures(right.session.temperature, [b.session.temperature for b in earlier])
    return Diagnosis(
        unit=right.session.unit,
        findings=(
            *gross_findings(rows.set_aside, rows),
            *clip_findings(session.clips, rows, state.baseline, calibration),
            *(record_error_finding(e, rows) for e in session.errors),
            *([] if entry is None else [entry_finding(entry)]),
            *with_temperature(changes, warmth),
        ),
        structures=(*wrong_record(wrong, right.session), *structures(state)),
        gain=gain(state, session.came, fitted, new),
        limits=limits(state),
        noise=noise_scales(state),
        baseline=calibrate(rows),
        calibration=calibration,
        notes=notes(state),
    )


def impossible_axes(right: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause]) -> ImplausibleAxes | None:
    """Axes that no block of this unit can have, whatever entry is corrected; None where there are none."""
    session = right.session
    expected = expected_axes(history, session)
    wrong = implausible_axes(right, expected)
    entry = None if wrong is None else wrong_entry(session, catalogue)
    return wrong if entry is None else implausible_axes(baseline_of(entry.corrected(session)), expected)


def searched(right: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause]) -> ExplainedSession:
    """The causes found in a session whose record is right."""
    return posterior(initial_state(right, history, catalogue))


def initial_state(right: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause]) -> ExplainedSession:
    """The residuals of a session, and nothing sought in them yet."""
    baseline, earlier = baselines(right, history)
    if not history:
        return begin(baseline, earlier, catalogue)
    own, known = settling_in(baseline, tuple(catalogue)), settling(about_their_flips(list(history)), tuple(catalogue))
    if own is not None:
        own = beside_history(own, *own.beside(right.session, history), tuple(catalogue))
        baseline, earlier = own.beside(right.session, history)
    return begin(*with_open_change(baseline, earlier, [own, *known]), catalogue)
