"""Step: judged changes since the last break → trends, the date of the next calibration and why then."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np
from numpy.typing import NDArray

from estimator.health.forecast import AHEAD, RISK_LEVEL, band, reach
from estimator.health.prognosis import Outlook, Prognosis, Track, prognosis
from estimator.session import comparable
from service.records.outlook import FanPoint, ParameterTrend, RiskPoint, UnitOutlook
from service.storage.queries.outlooks import ChangeRow, ReferenceRow
from service.words.due import why_due, why_measure
from service.words.names import YEAR

FAN_AHEAD = np.linspace(0.0, 1.0, 6)
"""Years after the last session for which a trend's bounds are drawn."""
FAN_LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Median, and the bounds that hold half and nine tenths, as `FanPoint` has them."""


@dataclass(frozen=True)
class Past:
    """What is stored of a unit that its outlook rests on."""

    serial: str
    since: datetime | None
    """Its last break; None where there was none."""
    changes: Sequence[ChangeRow]
    """Judged since the break."""
    references: Sequence[ReferenceRow]
    """Of the same time."""
    last: datetime | None
    """Its latest calibration; None before the first."""
    longest_days: float
    """From one calibration to the next, as the type allows."""


@dataclass(frozen=True)
class TrackKey:
    """Which parameter of which sensor."""

    sensor: str
    kind: str
    parameter: str


@dataclass(frozen=True, eq=False)
class Forecast:
    """What is stored of a unit, and what its page draws."""

    outlook: UnitOutlook
    keys: tuple[TrackKey, ...]
    tracks: tuple[Track, ...]
    dates: tuple[tuple[datetime, ...], ...]
    """Of every track's sessions, the reference included."""
    found: Prognosis | None
    """None without a track."""


def forecast(past: Past) -> Forecast:
    """The outlook of a unit."""
    groups = _groups(past.changes, past.references)
    dated = [_track(rows, reference) for rows, reference in groups.values()]
    tracks, dates = tuple(track for track, _ in dated), tuple(at for _, at in dated)
    found = prognosis(tracks) if tracks else None
    told = () if found is None else _trends(tuple(groups), tracks, dates, found)
    outlook = _unit(past, told, found, max((at[-1] for at in dates), default=None))
    return Forecast(outlook, tuple(groups), tracks, dates, found)


Group = tuple[list[ChangeRow], ReferenceRow]


def _groups(changes: Sequence[ChangeRow], references: Sequence[ReferenceRow]) -> dict[TrackKey, Group]:
    """The changes of each parameter from one reference; of a sensor with several references the latest programme's."""
    first: dict[tuple[str, tuple[str, ...]], ReferenceRow] = {}
    for reference in references:
        first.setdefault((reference.block, comparable(reference.programme)), reference)
    groups: dict[TrackKey, Group] = {}
    for row in changes:
        own = first.get((row.block, comparable(row.programme)))
        if own is not None:
            key = TrackKey(row.sensor, row.kind, row.parameter)
            rows, known = groups.get(key, ([], own))
            groups[key] = ([*rows, row], known) if known is own else ([row], own)
    return groups


def _track(rows: Sequence[ChangeRow], reference: ReferenceRow) -> tuple[Track, tuple[datetime, ...]]:
    """The sessions of a parameter with its reference among them, in order of time."""
    origin = (reference.at, [0.0] * len(rows[-1].change), rows[-1].origin)
    points = sorted([origin, *((row.at, row.change, row.own) for row in rows)], key=lambda point: point[0])
    start = points[0][0]
    track = Track(
        time=np.array([(at - start) / YEAR for at, _, _ in points]),
        change=np.array([change for _, change, _ in points]),
        sigma=np.array([sigma for _, _, sigma in points]),
        tolerance=rows[-1].tolerance,
    )
    return track, tuple(at for at, _, _ in points)


def _trends(
    keys: Sequence[TrackKey], tracks: Sequence[Track], dates: Sequence[tuple[datetime, ...]], found: Prognosis
) -> tuple[ParameterTrend, ...]:
    ahead = np.tile(FAN_AHEAD, (len(found.trends.rate), 1))
    fans = band(found.trends, ahead, FAN_LEVELS).quantiles
    parts = zip(keys, tracks, dates, found.outlooks, fans, strict=False)  # the axes' second series have no fan
    return tuple(_trend(*part) for part in parts)


def _trend(
    key: TrackKey, track: Track, dates: Sequence[datetime], found: Outlook, fan: NDArray[np.float64]
) -> ParameterTrend:
    points = zip(FAN_AHEAD, fan.T * track.tolerance, strict=True)
    return ParameterTrend(
        sensor=key.sensor,
        parameter=key.parameter,
        rate_per_year=found.rate,
        rate_sigma=found.rate_sigma,
        significance=found.p_value,
        step_dates=tuple(dates[k] for k in found.steps),
        level=found.level,
        level_sigma=found.level_sigma,
        reach_50=_after(dates[-1], found.reach_50) if found.is_known else None,
        reach_90=_after(dates[-1], found.reach_90) if found.is_known else None,
        population_z=None,
        kind=key.kind,
        tolerance=track.tolerance,
        since=dates[found.steps[-1]] if found.steps else dates[0],
        fan=tuple(FanPoint(dates[-1] + float(h) * YEAR, *(float(f"{q:.5g}") for q in at)) for h, at in points),
    )


def _after(start: datetime, years: float) -> datetime | None:
    return start + years * YEAR if np.isfinite(years) else None


def _unit(
    past: Past, trends: tuple[ParameterTrend, ...], found: Prognosis | None, latest: datetime | None
) -> UnitOutlook:
    """The unit as a whole: it comes back before its risk passes the level, and never after the longest interval."""
    last, since = past.last, past.since
    if last is None or (since is not None and last < since):
        return UnitOutlook(past.serial, since, False, why_measure(since), None, None, None, None, None, ())
    longest = last + timedelta(days=past.longest_days)
    first = min((t for t in trends if t.reach_90), key=lambda t: (t.reach_90, t.reach_50 or longest), default=None)
    risk, risky = tuple[RiskPoint, ...](), None
    if found is not None and latest is not None:
        risk = tuple(RiskPoint(latest + float(a) * YEAR, float(r)) for a, r in zip(AHEAD, found.risk, strict=True))
        risky = _after(latest, float(reach(found.risk[None], RISK_LEVEL)[0]))
    due = longest if risky is None else min(longest, max(risky, last))
    unit = UnitOutlook(
        serial=past.serial,
        due=due,
        overdue=False,
        reason=why_due(trends, first, last, past.longest_days, is_longest=due == longest),
        sensor=None if first is None else first.sensor,
        parameter=None if first is None else first.parameter,
        reach_50=None if first is None else first.reach_50,
        reach_90=None if first is None else first.reach_90,
        risk_at_due=None,
        trends=trends,
        risk=risk,
    )
    return replace(unit, risk_at_due=unit.risk_by(due))
