"""Step: histories and the priors of their type → trends, the next action for the unit, and its reason."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import numpy as np
from numpy.typing import NDArray

from estimator.health.detection import Change
from estimator.health.forecast import AHEAD, RISK_LEVEL, reach
from estimator.health.pooled import Prior
from estimator.health.prognosis import Outlook, Prognosis, prognosis
from estimator.health.shapes import Kind
from estimator.health.warmth import Warmth
from service.kit.measures import YEAR
from service.outlook.records import (
    Action,
    ChangeKind,
    DueBasis,
    DueRule,
    FanPoint,
    FoundChange,
    ParameterTrend,
    RiskPoint,
    TemperatureCoefficient,
    UnitOutlook,
)
from service.outlook.rules.histories import Histories
from service.outlook.words import UNFIT, reason_of
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession

FAN_AHEAD = np.linspace(0.0, 1.0, 6)
"""Years after the last session for which a trend's bounds are drawn."""
FAN_LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Median, and the bounds that hold half and nine tenths, as `FanPoint` has them."""
ACTIONS = {
    DueRule.UNFIT: Action.NOW,
    DueRule.UNDECIDED: Action.REPEAT,
    DueRule.MAY_BE_OUT: Action.REPEAT,
}
"""Next action for a unit without a date to wait for."""
CALLED: dict[Kind, ChangeKind] = {
    Kind.JUMP: "jump", Kind.LATE: "drift", Kind.START: "drift", Kind.AGING: "aging", Kind.WALK: "walk"
}  # fmt: skip
"""Kinds of change as `FoundChange` has them."""


@dataclass(frozen=True)
class Past:
    """Stored facts behind a unit's outlook, besides its histories."""

    serial: str
    since: datetime | None
    """Date of the unit's last break; None where there was none."""
    latest: StoredSession | None
    """The unit's latest calibration; None before the first."""
    longest_days: float
    """Longest time from one calibration to the next by the unit's type, days."""
    shown: StoredSession | None = None
    """The unit's latest session of any programme: a recording in service sets no date, but may find it unfit."""


def forecast(past: Past, known: Histories, priors: Mapping[tuple[str, str], Prior]) -> UnitOutlook:
    """The outlook of a unit; priors by kind of sensor and parameter."""
    last, since = past.latest, past.since
    if last is None or (since is not None and last.started_at < since):
        return _unmeasured(past)
    if not known.tracks:
        return _decided(past, last, _Foreseen((), (), np.zeros((0, len(AHEAD)))))
    found = prognosis(known.tracks, [priors[(key.kind, key.parameter)] for key in known.keys], FAN_AHEAD)
    trends = tuple(_trend(known, i, outlook) for i, outlook in enumerate(found.outlooks))
    learned = min(prior.histories for prior in priors.values())
    foreseen = _Foreseen(trends, _risk(known, found), found.chances(known.tracks))
    return replace(_decided(past, last, foreseen), learned_from=learned)


def _unmeasured(past: Past) -> UnitOutlook:
    """No session has shown it, ever or since its last service."""
    since = past.since
    basis = DueBasis(DueRule.UNMEASURED if since is None else DueRule.SERVICED, since)
    reason = reason_of(basis, since)
    unit = UnitOutlook(past.serial, since, False, reason, None, None, None, None, None, ())
    return replace(unit, action=Action.MEASURE, basis=basis)


def _trend(known: Histories, i: int, found: Outlook) -> ParameterTrend:
    key, track, dates = known.keys[i], known.tracks[i], known.dates[i]
    fan = found.fan.quantiles(FAN_LEVELS, found.direction) * track.tolerance
    points = zip(FAN_AHEAD, fan.T, strict=True)
    changes = tuple(_change(change, track.tolerance, dates) for change in found.changes)
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
        since=_since(found, dates),
        fan=tuple(FanPoint(dates[-1] + float(h) * YEAR, *(float(f"{q:.5g}") for q in at)) for h, at in points),
        changes=changes,
        temperature=None if found.warmth is None else _coefficient(found.warmth, track.tolerance),
    )


def _since(found: Outlook, dates: tuple[datetime, ...]) -> datetime:
    """The date of the first session under the rate in force."""
    drift = found.drift
    return dates[max([*found.steps, 0 if drift is None else max(drift.gap - 1, 0)])]


def _change(change: Change, tolerance: float, dates: tuple[datetime, ...]) -> FoundChange:
    """A found change in SI or relative; for an axis its length."""
    size, sigma = change.size, change.sigma
    length = float(size[0]) if len(size) == 1 else float(np.hypot(*size))
    spread = float(sigma[0]) if len(size) == 1 else float(np.hypot(*(sigma * size)) / max(length, 1e-300))
    after, before = (dates[change.gap - 1], dates[change.gap]) if change.gap else (dates[0], dates[1])
    return FoundChange(CALLED[change.kind], after, before, length * tolerance, spread * tolerance, change.p_value)


def _coefficient(warmth: Warmth, tolerance: float) -> TemperatureCoefficient:
    value, *curved = (float(size[0]) if len(size) == 1 else float(np.hypot(*size)) for size in warmth.size * tolerance)
    sigma = float(warmth.sigma.max()) * tolerance
    return TemperatureCoefficient(value, sigma, warmth.p_value, warmth.is_found, curved[0] if curved else None)


def _after(start: datetime, years: float) -> datetime | None:
    return start + years * YEAR if np.isfinite(years) else None


def _risk(known: Histories, found: Prognosis) -> tuple[RiskPoint, ...]:
    latest = max(at[-1] for at in known.dates)
    return tuple(RiskPoint(latest + float(a) * YEAR, float(r)) for a, r in zip(AHEAD, found.risk, strict=True))


@dataclass(frozen=True, eq=False)
class _Foreseen:
    """Forecast from the histories; empty where there are none."""

    trends: tuple[ParameterTrend, ...]
    risk: tuple[RiskPoint, ...]
    chances: NDArray[np.float64]
    """(B, h) of every trend to be out of tolerance, 0 where its level is not known, at the dates of the risk."""

    def riskiest(self, at: datetime) -> ParameterTrend:
        """The trend that is out of tolerance by a date with the largest chance."""
        years = (at - self.risk[0].at) / YEAR
        return self.trends[int(np.argmax([np.interp(years, AHEAD, row) for row in self.chances]))]


def _decided(past: Past, last: StoredSession, foreseen: _Foreseen) -> UnitOutlook:
    """The unit as a whole: it comes back before its risk passes the level, and never after the longest interval.

    Found unfit, by a recording in service too, it needs a hand and no date; undecided, or perhaps out of tolerance
    already, another session.
    """
    longest = last.started_at + timedelta(days=past.longest_days)
    first = min(
        (t for t in foreseen.trends if t.reach_90), key=lambda t: (t.reach_90, t.reach_50 or longest), default=None
    )
    basis, due = _basis(past, last, foreseen)
    unit = UnitOutlook(
        serial=past.serial,
        due=due,
        overdue=False,
        reason=reason_of(basis, due),
        sensor=None if first is None else first.sensor,
        parameter=None if first is None else first.parameter,
        reach_50=None if first is None else first.reach_50,
        reach_90=None if first is None else first.reach_90,
        risk_at_due=None,
        trends=foreseen.trends,
        risk=foreseen.risk,
        action=ACTIONS.get(basis.rule, Action.CALIBRATE),
        basis=basis,
    )
    return unit if due is None else replace(unit, risk_at_due=unit.risk_by(due))


def _basis(past: Past, last: StoredSession, foreseen: _Foreseen) -> tuple[DueBasis, datetime | None]:
    found = next((s for s in (past.shown, last) if s is not None and s.verdict in UNFIT), None)
    if found is not None:
        return DueBasis(DueRule.UNFIT, found.started_at), None
    if last.verdict is Verdict.UNDECIDABLE and not last.is_reference:
        return DueBasis(DueRule.UNDECIDED, last.started_at, because=last.reason), None
    longest = last.started_at + timedelta(days=past.longest_days)
    if not foreseen.risk:
        return DueBasis(DueRule.NO_TREND, last.started_at, interval_days=past.longest_days), longest
    risky = _passes(foreseen.risk)
    if risky is None or risky >= longest:
        return DueBasis(DueRule.INTERVAL, last.started_at, interval_days=past.longest_days), longest
    is_out, worst = risky <= last.started_at, foreseen.riskiest(risky)
    rule = DueRule.MAY_BE_OUT if is_out else DueRule.RISK
    basis = DueBasis(rule, last.started_at, risk=RISK_LEVEL, sensor=worst.sensor, parameter=worst.parameter)
    return basis, None if is_out else risky


def _passes(risk: tuple[RiskPoint, ...]) -> datetime | None:
    years = float(reach(np.array([[point.risk for point in risk]]), RISK_LEVEL)[0])
    return _after(risk[0].at, years)
