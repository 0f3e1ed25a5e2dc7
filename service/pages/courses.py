"""The course of one parameter of one sensor as a chart of its own, beside what is said of it."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.message import say
from service.diagnosis.records import DiagnosisReport
from service.diagnosis.words.causes import what_is_wrong
from service.kit.measures import PARAMETER_NAMES
from service.outlook.charts import history_charts, tracks_of
from service.outlook.records import UnitOutlook
from service.outlook.store import Outlooks
from service.papers.certified import recent_history
from service.sessions.charts import ChartSet
from service.sessions.decision import Decision, worst_of
from service.sessions.history_store import HistoryQuery
from service.sessions.records import HistoryPoint
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.units.records import Note, Service
from service.units.store import Services

HISTORY_LIMIT = 10_000
"""Points of one parameter's history that a page draws, of the newest sessions: 1,600 of six sensors, 200 of 48."""
MOST = 3
"""Sensors whose courses a diagnosis draws."""


def course_chart(
    points: Sequence[HistoryPoint],
    services: Sequence[Service],
    outlook: UnitOutlook | None,
    notes: Sequence[Note] = (),
    name: str = "worst",
) -> ChartSet:
    """The chart of one parameter's history, at least one point, with its tolerance, U and forecast."""
    ((track,),) = tracks_of(points, services)
    found = history_charts([track], services, notes, () if outlook is None else outlook.trends)
    title = say("{sensor} {parameter}", sensor=track.sensor, parameter=PARAMETER_NAMES[track.parameter])
    return replace(found, name=name, panels=(replace(found.panels[0], title=title, condition=None),))


def changed_courses(store: Store, report: DiagnosisReport) -> tuple[ChartSet, ...]:
    """For findings that are changes since earlier sessions: the parameter of each sensor that is nearest to its
    tolerance, with the session that shows the change marked."""
    found = None if report.diagnosis is None else report.diagnosis.found
    changes = [] if found is None else [finding for finding in found.findings if is_change(finding)]
    if found is None or not changes:
        return ()
    unit, decisions = report.session.unit, Sessions(store).decisions(report.session.id)
    services, outlook = Services(store).of_unit(unit), Outlooks(store).of_unit(unit)
    charts: list[ChartSet] = []
    for finding, decision in list(_concerned(changes, decisions))[:MOST]:
        wanted = HistoryQuery(parameter=decision.parameter, sensor=decision.sensor, kind=decision.kind)
        points = recent_history(store, unit, HISTORY_LIMIT, wanted)
        note = _mark(report, what_is_wrong(finding, found.findings))
        if points:
            charts.append(course_chart(points, services, outlook, (note,), f"changed-{len(charts)}"))
    return tuple(charts)


def is_change(finding: Finding) -> bool:
    """Whether a finding is a change since earlier sessions, which the readings of one session cannot show."""
    known = find(finding.cause)
    return known is not None and known.between


def _concerned(changes: Sequence[Finding], decisions: tuple[Decision, ...]) -> Iterator[tuple[Finding, Decision]]:
    """The worst decision on every sensor that a finding names."""
    for finding in changes:
        for sensor in finding.sensors:
            worst = worst_of(tuple(decision for decision in decisions if decision.sensor == sensor))
            if worst is not None:
                yield finding, worst


def _mark(report: DiagnosisReport, text: str) -> Note:
    session = report.session
    return Note(0, session.unit, session.started_at, text, "", session.uploaded_at, withdrawal=None, session=session.id)
