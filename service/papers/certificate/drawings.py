"""The charts of the paper: histories of the parameters closest to their tolerance, and residuals."""

from dataclasses import dataclass

from estimator.message import say
from service.kit.measures import spaced
from service.languages.language import Language
from service.outlook.charts import history_charts, tracks_of
from service.papers.certified import CertifiedSession
from service.papers.typeset import picture
from service.sessions.charts import ChartSet
from service.sessions.course_charts import charts_of_fit
from service.sessions.decision import Decision

MOST_HISTORIES = 6
"""Histories that are drawn, of the parameters closest to their tolerance."""
MOST_RESIDUALS = 12
"""Panels of residuals that are drawn, the first ones; the session's page has all."""
WIDTH = 235
"""Width of one drawn panel, pixels."""


@dataclass(frozen=True)
class Drawing:
    """One panel of a chart."""

    title: str
    text: str
    svg: str


def histories_of(found: CertifiedSession, language: Language) -> tuple[Drawing, ...]:
    """Histories of the parameters closest to their tolerance."""
    closest = sorted(found.report.decisions, key=_rank)[:MOST_HISTORIES]
    keys = [(d.parameter, d.sensor) for d in closest if d.margin is not None]
    drawings: dict[tuple[str, str], Drawing] = {}
    for tracks in tracks_of(found.history, found.services):
        charts = history_charts(tracks, found.services)
        drawings |= {
            (track.parameter, track.sensor): _drawing(
                charts,
                place,
                say("{sensor} {parameter}", sensor=track.sensor, parameter=spaced(track.parameter)),
                language,
            )
            for place, track in enumerate(tracks)
            if (track.parameter, track.sensor) in keys and len(track.points) > 1
        }
    return tuple(drawings[key] for key in keys if key in drawings)


def _rank(decision: Decision) -> float:
    margin = decision.margin
    return float("inf") if margin is None else margin


def residuals_of(found: CertifiedSession, language: Language) -> tuple[Drawing, ...]:
    """Residuals against the angle of the head on a stand, the course of a recording in service, else in the order
    measured.
    """
    chart_sets = charts_of_fit(found.report.calibration)
    first = chart_sets[0].name.rpartition("-")[2] if chart_sets else ""
    selected = [
        (charts, place) for charts in chart_sets if charts.name.endswith(first) for place in range(len(charts.panels))
    ]
    return tuple(
        _drawing(charts, place, charts.panels[place].title, language) for charts, place in selected[:MOST_RESIDUALS]
    )


def _drawing(charts: ChartSet, place: int, title: str, language: Language) -> Drawing:
    panel = charts.panels[place]
    return Drawing(title, panel.description, picture(charts, panel, WIDTH, language))
