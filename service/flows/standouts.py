"""Flow: units and production lots whose drift stands out of their type, at one level for the whole fleet."""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.health.population import group_standing, standing_out
from service.outlook import ParameterTrend, UnitOutlook
from service.words import PARAMETER_NAMES

WORTH = 0.1
"""Tolerances a year: slower drifts are nobody's concern, however unlike the others they are."""


@dataclass(frozen=True)
class Standout:
    """A unit or a lot that drifts unlike the others of its type."""

    unit: str | None
    """Serial number; None for a lot."""
    text: str


def standouts(outlooks: Sequence[UnitOutlook]) -> tuple[Standout, ...]:
    """Units first, the furthest out first; then lots."""
    placed = [(o, t) for o in outlooks for t in o.trends if t.population_z is not None]
    out = standing_out([trend.population_z or 0.0 for _, trend in placed])
    units = [
        (abs(t.population_z or 0.0), Standout(o.serial, f"{t.sensor} {PARAMETER_NAMES[t.parameter]} {_rate(t)}"))
        for (o, t), far in zip(placed, out, strict=True)
        if far and abs(t.rate_per_year) > WORTH * t.tolerance
    ]
    ordered = sorted(units, key=lambda found: -found[0])
    return (*(standout for _, standout in ordered), *_lots(outlooks))


def _rate(trend: ParameterTrend) -> str:
    share = 100 * abs(trend.rate_per_year) / trend.tolerance
    return f"drifts by {share:.0f} % of its tolerance a year, unlike the other units of its type."


def _lots(outlooks: Sequence[UnitOutlook]) -> list[Standout]:
    groups: dict[tuple[str, str, str], list[tuple[UnitOutlook, ParameterTrend]]] = {}
    for outlook in outlooks:
        for trend in outlook.trends:
            groups.setdefault((outlook.unit_type, trend.kind, trend.parameter), []).append((outlook, trend))
    z = {
        (unit_type, parameter, lot): found
        for (unit_type, _, parameter), own in groups.items()
        for lot, found in group_standing(
            [(t.rate_per_year / t.tolerance, t.rate_sigma / t.tolerance) for _, t in own], [o.lot or "" for o, _ in own]
        ).items()
        if len({o.serial for o, _ in own if o.lot == lot}) > 1
    }
    return [
        Standout(None, f"Lot {lot} of {unit_type}: {PARAMETER_NAMES[parameter]} drifts unlike that of the other units.")
        for (unit_type, parameter, lot), far in zip(z, standing_out(list(z.values())), strict=True)
        if far
    ]
