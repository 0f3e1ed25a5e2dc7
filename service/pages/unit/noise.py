"""What a unit's page shows of noise at rest: every term through time, beside bias and scale."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

from estimator.allan.results import TERMS
from estimator.message import say
from service.kit.measures import NOISE, in_measure
from service.kit.names import day_of
from service.outlook.charts import history_charts
from service.outlook.tracks import Track, TrackPoint
from service.sessions.charts import ChartSet
from service.sessions.records import HistoryPoint
from service.sessions.words.conditions import NOT_JUDGED
from service.sessions.words.noise import MEANINGS, NAMES, grown, term_in_words
from service.units.records import Note, Service


@dataclass(frozen=True)
class NoiseRow:
    """One session's sizes of one term, a cell a sensor."""

    session: str
    day: str
    iso: str
    cells: tuple[str, ...]


@dataclass(frozen=True)
class NoiseSection:
    """One term of all sensors of a kind."""

    anchor: str
    heading: str
    meaning: str
    charts: ChartSet
    sensors: tuple[str, ...]
    rows: tuple[NoiseRow, ...]
    """Newest first."""


@dataclass(frozen=True)
class NoisePart:
    """Everything of noise."""

    grown: tuple[str, ...]
    """What is larger than before, in a sentence each."""
    sections: tuple[NoiseSection, ...]
    undecided: tuple[str, ...]
    """Names of the terms that no session decides."""


def noise_part(points: Sequence[HistoryPoint], services: Sequence[Service], notes: Sequence[Note]) -> NoisePart | None:
    """Of a unit's terms, oldest first; None where no session tells any."""
    if not points:
        return None
    kinds = sorted({point.kind for point in points})
    sections, undecided = [], []
    for name in NAMES:
        for kind in kinds:
            own = [point for point in points if (point.parameter, point.kind) == (name, kind)]
            heading = say("{heading}, {kind}", heading=NAMES[name], kind=f"{kind}s") if len(kinds) > 1 else NAMES[name]
            if any(point.value is not None for point in own):
                sections.append(_section(own, heading, services, notes))
            elif own:
                undecided.append(heading)
    return NoisePart(grown(points), tuple(sections), tuple(undecided))


def without_noise(points: Sequence[HistoryPoint]) -> tuple[tuple[HistoryPoint, ...], tuple[HistoryPoint, ...]]:
    """What is judged, and the terms of noise."""
    judged = tuple(point for point in points if point.parameter not in TERMS)
    return judged, tuple(point for point in points if point.parameter in TERMS)


def _section(
    points: Sequence[HistoryPoint], heading: str, services: Sequence[Service], notes: Sequence[Note]
) -> NoiseSection:
    first = points[0]
    sensors = tuple(dict.fromkeys(point.sensor for point in points))
    decided = [sensor for sensor in sensors if any(p.value is not None for p in points if p.sensor == sensor)]
    tracks = [_track([p for p in points if p.sensor == sensor]) for sensor in decided]
    return NoiseSection(
        anchor=f"{first.parameter}-{first.kind}",
        heading=heading,
        meaning=MEANINGS[first.parameter],
        charts=history_charts(tracks, services, notes),
        sensors=sensors,
        rows=tuple(reversed([_row(list(own), sensors) for _, own in groupby(points, key=lambda p: p.session)])),
    )


def _track(points: Sequence[HistoryPoint]) -> Track:
    first = points[0]
    measure = NOISE[first.kind, first.parameter]
    shown = tuple(
        TrackPoint(
            at=point.at,
            session=point.session,
            shown=in_measure(point.value, measure),
            lower=in_measure(point.lower, measure),
            upper=in_measure(point.upper, measure),
            limit_lower=None,
            limit_upper=None,
            epoch=0,
            text=term_in_words(point),
            condition=NOT_JUDGED,
        )
        for point in points
    )
    return Track(f"{first.parameter}-{first.kind}", first.sensor, first.parameter, measure, shown)


def _row(points: Sequence[HistoryPoint], sensors: Sequence[str]) -> NoiseRow:
    cells = {point.sensor: term_in_words(point) for point in points}
    at = points[0].at
    return NoiseRow(points[0].session, day_of(at), at.isoformat(), tuple(cells.get(sensor, "–") for sensor in sensors))
