"""Diagnosis of the sessions of a unit, a unit type or a stand together, where no single session shows enough.

statistics → layout → evidence → selection → findings
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.catalogue import cause
from estimator.diagnosis.explanation.naming import side_by_side
from estimator.groups.findings import LARGEST, Estimated, estimated, finding_of, structures
from estimator.groups.gain import gain_of, names_that_predict
from estimator.groups.lack_of_fit import LackOfFitGroup, names_that_fit
from estimator.groups.layout import EVERY, LEVELS, STAND, TYPE, UNIT, GroupLayout
from estimator.groups.limits import limits
from estimator.groups.pictures import pictures
from estimator.groups.place import Where
from estimator.groups.pool import PoolModel, pooled
from estimator.groups.results import EmpiricalTerm, GroupDiagnosis, GroupFinding
from estimator.groups.selection import GroupSelection, select
from estimator.groups.separation import Separator
from estimator.groups.session_statistics import statistics_of
from estimator.groups.statistics import SessionStatistics
from estimator.groups.terms import Library, learn, shown
from estimator.message import joined, say
from estimator.session import CALIBRATIONS, CalibrationSession


def diagnose_group(sessions: Sequence[CalibrationSession], level: str = UNIT) -> GroupDiagnosis:
    """Diagnoses several sessions together.

    Parameters
    ----------
    sessions : of programmes that calibrate a block, oldest first. For ``unit`` of one unit; for ``type`` and ``stand``
        of several. The group is that of the last session: its unit, its type, its stand. Sessions of the same units on
        other stands, where there are any, tell whether an effect is the stand's or the units'.
    level : ``unit``, ``type`` or ``stand``.

    Raises
    ------
    ValueError : no session, none that calibrates a block, or another level.
    ScheduleError : a session cannot be calibrated at all.
    """
    usable = [s for s in sessions if s.programme in CALIBRATIONS]
    if not usable:
        raise ValueError("a group needs a session that calibrates a block")
    return diagnose_statistics([statistics_of(s) for s in usable], level, usable)


def diagnose_statistics(
    statistics: Sequence[SessionStatistics], level: str = UNIT, sessions: Sequence[CalibrationSession] = ()
) -> GroupDiagnosis:
    """Diagnoses a group from the statistics kept of its sessions, oldest first.

    ``sessions``: the same sessions, where they are at hand. Without them nothing is said of the measurement that would
    tell rivals apart, of what moved, or of learned terms, and beside every name stands that it may be something
    ``unexplained``: only the readings tell whether something outside the catalogue fits better.
    """
    if level not in LEVELS:
        raise ValueError(say("a group is one of {levels}, not {level}", levels=joined(", ", LEVELS), level=level))
    if not statistics:
        raise ValueError("a group needs a session that calibrates a block")
    layout = GroupLayout.of(statistics, level)
    selection = names_that_predict(select(layout))
    group = LackOfFitGroup(selection, tuple(sessions))
    selection = names_that_fit(group)
    effects = [estimated(selection, f) for f in selection.found]
    separator = Separator(tuple(sessions))
    found = [finding_of(selection, effect, separator.measurements(selection, effect)) for effect in effects]
    scale = selection.weighed()
    whole = merged(found)
    drawn = pictures(whole, sessions) if sessions else [None] * len(whole)
    return GroupDiagnosis(
        level=level,
        subject=subject_of(statistics[-1], level),
        sessions=len(statistics),
        first=statistics[0].started_at,
        last=statistics[-1].started_at,
        findings=tuple(replace(f, picture=picture) for f, picture in zip(whole, drawn, strict=True)),
        terms=tuple(learned_terms(selection, level, group)),
        structures=structures(selection),
        limits=limits(pooled(layout, PoolModel(), selection.scale), level),
        gain=gain_of(selection, found, sessions),
        e_value=float(np.exp(min(scale.log_e_value, LARGEST))),
        notes=tuple(notes(selection, effects)),
    )


def learned_terms(selection: GroupSelection, level: str, group: LackOfFitGroup) -> Iterator[EmpiricalTerm]:
    """Empirical terms where the sessions share structure that no cause explains, place by place.

    What has a name is left free in every session.
    """
    named = [(f.hypothesis.cause, f.hypothesis.sensor, f.hypothesis.shape) for f in selection.found]
    whole_type = subject_of(selection.layout.parts[-1].statistics, TYPE)
    places = dict.fromkeys(
        (h.sensor, *((TYPE, whole_type) if level == TYPE and h.sensor else (h.level, h.subject)))
        for h, _ in selection.structures
    )
    for sensor, term_level, subject in places if group.sessions else ():
        fits = [fit for fit in group.fitted if Where(term_level, subject, sensor, "").concerns(fit.record)]
        whole = [Library.of(fit.baseline, sensor, named) for fit in fits] if sensor != EVERY else []
        terms = learn(sensor, whole)
        if terms is not None:
            yield replace(shown(subject, terms, whole), level=term_level)


def subject_of(session: SessionStatistics, level: str) -> str:
    """The unit, type or stand that the group belongs to."""
    return {UNIT: session.unit, TYPE: session.unit_type, STAND: session.stand}[level]


def merged(found: Sequence[GroupFinding]) -> list[GroupFinding]:
    """Findings of one cause on several sensors of one subject put together where their sessions are the same."""
    kept: dict[tuple[object, ...], GroupFinding] = {}
    for f in found:
        dates = tuple((s.started_at, s.unit) for s in f.sessions)
        key = (f.cause, f.level, f.subject, f.kind, f.form, f.since, f.shape, dates)
        kept[key] = f if key not in kept else as_one(kept[key], f)
    return list(kept.values())


def as_one(a: GroupFinding, b: GroupFinding) -> GroupFinding:
    """Two findings of one cause as one."""
    return replace(
        a,
        **side_by_side(cause(a.cause), a, b, ("spread", "rivals")),
        e_value=min(a.e_value, b.e_value),
        cochran=min(a.cochran, b.cochran),
        sessions=tuple(
            replace(x, amplitude=x.amplitude + y.amplitude, sigma=x.sigma + y.sigma)
            for x, y in zip(a.sessions, b.sessions, strict=True)
        ),
    )


def notes(selection: GroupSelection, effects: Sequence[Estimated]) -> list[str]:
    """Remarks for readers of the findings."""
    found: list[str] = []
    for f, h in selection.misfits:
        where = say(" on {sensor}", sensor=f.sensor) if f.sensor else ""
        if h.shape is None:
            found.append(
                say(
                    "{cause}{place} is close, but {combination} agrees better: it has no name",
                    cause=f.cause,
                    place=where,
                    combination=joined(" + ", h.words),
                )
            )
        else:
            found.append(
                say(
                    "{cause}{place} is close, but leaves harmonic {shape} of β: it does not agree",
                    cause=f.cause,
                    place=where,
                    shape=f"{h.shape:g}",
                )
            )
    alone = [selection.layout.parts[k].statistics.started_at for k in sorted({k for k, _ in selection.of_one_session})]
    if alone:
        dates = dict.fromkeys(date or "one without a date" for date in alone)
        found.append(say("removed from single sessions that show it on their own: {dates}", dates=joined(", ", dates)))
    larger = {p.statistics.unit: s for p, s in zip(selection.layout.parts, selection.scale, strict=True) if s > 1.5}
    found += [
        say("{unit}: the sessions scatter {ratio} times as much as stated", unit=u, ratio=f"{np.sqrt(s):.1f}")
        for u, s in larger.items()
    ]
    return found
