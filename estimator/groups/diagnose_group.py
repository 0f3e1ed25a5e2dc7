"""Diagnosis of the sessions of a unit, a unit type or a stand together, where no single session shows enough.

statistics → pool → search → course → findings
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.catalogue import cause
from estimator.diagnosis.explanation.naming import side_by_side
from estimator.groups.course import AnsweredGroup, answered
from estimator.groups.findings import LARGEST, effect_of, finding_of, structures
from estimator.groups.gain import gain_of
from estimator.groups.layout import pool_of
from estimator.groups.learned import learned_terms
from estimator.groups.limits import limits
from estimator.groups.pictures import pictures
from estimator.groups.priors import LEVELS, STAND, TYPE, UNIT
from estimator.groups.results import GroupDiagnosis, GroupFinding
from estimator.groups.separation import Separator
from estimator.groups.session_statistics import statistics_of
from estimator.groups.statistics import SessionStatistics
from estimator.message import joined, say
from estimator.session import CALIBRATIONS, CalibrationSession

NOTED = 1.5
"""Times the stated variance from which on readers are told how much the sessions scatter."""


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
    answer = answered(pool_of(statistics, level), statistics, sessions)
    model = answer.model
    effects = [effect_of(answer, term) for term in model.named]
    separator = Separator(tuple(sessions))
    found = [finding_of(answer, effect, separator.measurements(effect)) for effect in effects]
    whole = merged(found)
    drawn = pictures(whole, sessions) if sessions else [None] * len(whole)
    return GroupDiagnosis(
        level=level,
        subject=subject_of(statistics[-1], level),
        sessions=len(statistics),
        first=statistics[0].started_at,
        last=statistics[-1].started_at,
        findings=tuple(replace(f, picture=picture) for f, picture in zip(whole, drawn, strict=True)),
        terms=tuple(learned_terms(answer, level)),
        structures=tuple(structure for _, structure in structures(answer)),
        limits=limits(model.pool, level),
        gain=gain_of(answer, found, sessions),
        e_value=float(np.exp(min(model.weighed().log_e_value, LARGEST))),
        notes=tuple(notes(answer)),
    )


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


def notes(answer: AnsweredGroup) -> list[str]:
    """Remarks for readers of the findings."""
    found: list[str] = []
    for says in answer.courses.values():
        words = joined(" + ", [word for h in says.course for word in h.words])
        for h in says.withdrawn:
            where = say(" on {sensor}", sensor=h.sensor) if h.sensor else ""
            parts = {"cause": h.cause, "place": where, "combination": words}
            found.append(say("{cause}{place} is close, but {combination} agrees better: it has no name", **parts))
    alone = [answer.records[k].started_at for k in sorted({k for t in answer.model.own for k in t.sessions})]
    if alone:
        dates = dict.fromkeys(date or "one without a date" for date in alone)
        found.append(say("removed from single sessions that show it on their own: {dates}", dates=joined(", ", dates)))
    larger = {part.subjects[0]: part.scale for part in answer.model.pool.parts if part.scale > NOTED}
    found += [
        say("{unit}: the sessions scatter {ratio} times as much as stated", unit=u, ratio=f"{np.sqrt(s):.1f}")
        for u, s in larger.items()
    ]
    return found
