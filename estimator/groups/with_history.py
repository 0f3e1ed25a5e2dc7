"""A diagnosis with the evidence of the unit's earlier sessions: what no session alone shows, and all together do.

A session's own readings are searched first. Then its statistics and those of the earlier sessions are pooled, by the
rules that hold for a group. An effect that they show together, and the session by itself does not name, is taken out
of the readings of every session at the amplitude that the others have, and the search is made anew: what is left is
the session's own. So its name, its amplitude and the gain rest on readings that took no part.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.catalogue import CATALOGUE, cause
from estimator.causes.contract import Cause
from estimator.content import remembered
from estimator.diagnosis.diagnose import PutRight, diagnosed, put_right
from estimator.diagnosis.diagnose import diagnose as by_itself
from estimator.diagnosis.explanation.extended_model import enlarged
from estimator.diagnosis.explanation.naming import merged, named_cause
from estimator.diagnosis.record.clipping import earlier_baseline
from estimator.diagnosis.record.silent import silent_channels
from estimator.diagnosis.record.undo import undo_record_errors
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.flipped_run import with_fitted_flip
from estimator.diagnosis.results import Diagnosis, Finding, OverSessions
from estimator.groups.fixed import added_by, fixed, taken_out
from estimator.groups.lasting import ENDED, SURE, Lasting, lasting
from estimator.groups.session_statistics import kept
from estimator.groups.statistics import SessionStatistics
from estimator.message import say
from estimator.session import CALIBRATIONS, Array, CalibrationSession

MANY = 16
"""Sensors from which on the earlier sessions' statistics are not made beside a diagnosis: they would take longer than
it does. `diagnose_group` makes them, and what was kept of the sessions may be passed in."""


def diagnose(
    session: CalibrationSession,
    history: Sequence[CalibrationSession] = (),
    *,
    catalogue: Sequence[Cause] = CATALOGUE,
    records: Sequence[SessionStatistics] | None = None,
) -> Diagnosis:
    """Diagnoses a session with its history, and names the effects that only all sessions of the unit together show.

    Parameters
    ----------
    session : of a programme that calibrates a block; of an alignment on a turntable, where lever arms are looked for.
    history : earlier sessions of the unit, oldest first; one with a channel that reads the same in every row is passed
        over.
    catalogue : the causes to consider.
    records : what `statistics_of` kept of earlier sessions, oldest first, of the history and of sessions before it;
        None where it is to be made of the history.

    Raises
    ------
    ScheduleError : the session cannot be calibrated at all, or a channel reads the same in every row.
    """
    history = [h for h in history if not silent_channels(h)]
    pooled = session.programme in CALIBRATIONS and (records if records is not None else history)
    if not pooled:
        return by_itself(session, history, catalogue=catalogue)
    begun = put_right(session, history, catalogue)
    alone = diagnosed(begun, catalogue)
    if records is None:
        records = () if len(session.sensors) > MANY else [record_of(h, tuple(catalogue)) for h in history]
    if not records or any(s.of_record for s in alone.structures):
        return alone
    now = kept(begun.right.session, with_fitted_flip(begun.right), ())
    sessions = (*history, begun.right.session)[-len(records) - 1 :]
    return with_lasting(begun, alone, lasting([*records, now], catalogue, sessions), catalogue)


@remembered
def record_of(earlier: CalibrationSession, catalogue: tuple[Cause, ...]) -> SessionStatistics:
    """The statistics of a session of the history, its record corrected."""
    _, right = undo_record_errors(earlier_baseline(earlier, catalogue), (), catalogue)
    return kept(right.session, with_fitted_flip(right), ())


def with_lasting(begun: PutRight, alone: Diagnosis, found: Sequence[Lasting], catalogue: Sequence[Cause]) -> Diagnosis:
    """The session's own diagnosis with the lasting effects that it has and does not show by itself.

    One that it shows once that of the others is taken out has another amplitude here: it is the session's own then.
    What has ended is taken out of the history, whose parameters absorbed it: else its end would show as a new effect.
    """
    ended = [effect for effect in found if effect.probability < (SURE if names(alone, effect) else ENDED)]
    wanted = [effect for effect in found if effect.probability >= SURE and not names(alone, effect)]
    while wanted or ended:
        rest, more = without(begun, wanted, ended)
        left = diagnosed(rest, catalogue)
        held = [effect for effect in wanted if not names(left, effect)]
        if len(held) == len(wanted):
            named = merged([(cause(effect.finding.cause), finding_of(effect)) for effect in wanted])
            return replace(
                left,
                findings=(*left.findings, *named),
                gain=replace(left.gain, before=alone.gain.before),
                baseline=alone.baseline,
                calibration=enlarged(left.calibration, more, begun.right.parameters.axis_tangents),
                notes=(*alone.notes, *map(words_of_end, ended)),
            )
        wanted = held
    return alone


def names(diagnosis: Diagnosis, effect: Lasting) -> bool:
    """Whether a diagnosis names an effect by itself."""
    finding = effect.finding
    return any(f.cause == finding.cause and set(finding.sensors) <= set(f.sensors) for f in diagnosis.findings)


def without(begun: PutRight, lasting: Sequence[Lasting], ended: Sequence[Lasting]) -> tuple[PutRight, Array]:
    """A session without lasting effects and its history without these and those that ended; and what is not known of
    the lasting ones as covariance of the session's parameters (P, P), SI."""
    right, more = taken_from(begun.right, lasting)
    count, known = len(begun.earlier), [*lasting, *ended]
    earlier = tuple(
        taken_from(b, [effect for effect in known if count - k <= effect.began])[0] for k, b in enumerate(begun.earlier)
    )
    return replace(begun, right=right, earlier=earlier), more


def taken_from(baseline: Baseline, effects: Sequence[Lasting]) -> tuple[Baseline, Array]:
    """One session without effects that it has."""
    added = added_by(baseline, [fixed(effect.others) for effect in effects], ())
    if added is None:
        return baseline, np.zeros(baseline.covariance.shape)
    rest, more = taken_out(baseline, added)
    return baseline_of(rest), more


def finding_of(effect: Lasting) -> Finding:
    """A lasting effect as a finding of the session; its amplitude is that of all sessions."""
    whole, known = effect.finding, cause(effect.finding.cause)
    return replace(
        named_cause(known, whole.sensors, min(1.0, 1 / whole.e_value), whole.strength),
        amplitude=whole.amplitude,
        sigma=tuple(0.0 if s is None else s for s in whole.sigma),
        units=whole.units,
        nonlinear_each=({} if whole.shape is None else {"s": whole.shape},),
        alternatives=whole.alternatives,
        ranking=effect.ranking,
        new=None if whole.form == "since" else False,
        over_sessions=OverSessions(
            sessions=effect.sessions,
            e_value=whole.e_value,
            form=whole.form,
            since=whole.since,
            spread=whole.spread,
            here=effect.probability,
        ),
    )


def words_of_end(effect: Lasting) -> str:
    """States that the session lacks an effect of the earlier ones."""
    known = cause(effect.finding.cause).name.capitalize()
    where = say(" on {sensors}", sensors=effect.finding.sensors[0]) if effect.finding.sensors else ""
    parts = {"known": known, "place": where, "sessions": effect.sessions - 1}
    return say("{known}{place}: {sessions} earlier sessions together show it; this one does not.", **parts)
