"""Calibration under a model that holds accepted causes: their amplitudes are fitted, whatever their significance."""

from collections.abc import Sequence
from dataclasses import replace

from estimator.calibration.calibrate import averaged, calibrate
from estimator.causes.catalogue import cause
from estimator.causes.contract import Signature
from estimator.causes.sensor import ReadingOutlier
from estimator.diagnosis.explanation.extended_model import amplitudes, extended_calibration
from estimator.diagnosis.posterior.explained import Detection, begin
from estimator.diagnosis.posterior.refine import bent
from estimator.diagnosis.posterior.solve import SessionTerms, at_their_best
from estimator.diagnosis.posterior.term import ListedTerms, Place, Term
from estimator.diagnosis.posterior.write import scored
from estimator.diagnosis.record.clipping import unclipped
from estimator.diagnosis.residuals.flipped_run import with_its_flip
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
    done = {(clip.cause.identifier, (clip.sensor,)) for clip in clips}
    names = [sensor.name for sensor in rows.sensors]
    done |= {(ReadingOutlier.identifier, (names.index(out.sensor),)) for out in rows.set_aside}
    every = [(identifier, place) for identifier, sensors in causes for place in places(rows, sensors)]
    state = begin(with_its_flip(whole), (), known)
    signatures = [c for c in known if isinstance(c, Signature)]
    detections = accepted_at(SessionTerms.of_causes(state.residuals, signatures), [p for p in every if p not in done])
    if not detections:
        return calibrate(whole)
    state = replace(state, detections=detections)
    return extended_calibration(state, amplitudes(state))


def places(session: CalibrationSession, sensors: Sequence[str]) -> list[tuple[int, ...]]:
    """Places of a cause: sensor by sensor, or one empty place for no sensor in particular."""
    names = [s.name for s in session.sensors]
    return [(names.index(s),) for s in sensors if s in names] if sensors else [()]


def accepted_at(session: SessionTerms, wanted: Sequence[Place]) -> tuple[Detection, ...]:
    """Causes at their places, each in the shape that fits best beside the others; where it cannot show, none."""
    terms: tuple[Term, ...] = ()
    kinds = [kind for kind in session.model.of_causes if isinstance(kind, ListedTerms)]
    for place in wanted:
        there = session.model.beside(terms).candidates(kinds)
        terms = (*terms, *(c.term() for c in there if c.place == place))
    terms = at_their_best(session, terms)
    found = []
    for k, term in enumerate(terms):
        info = session.model.beside(terms[:k] + terms[k + 1 :]).info
        (best,) = scored(session, info, term, bent(session.single, info, term))
        found.append(Detection(best, best.p_value, ()))
    return tuple(found)
