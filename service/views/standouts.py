"""Units and production lots whose drift stands out of their type, at one level for the whole fleet."""

from collections.abc import Sequence
from dataclasses import dataclass

from estimator.health.population import group_standing, standing_out
from service.records.outlook import Rate
from service.storage.store import Store
from service.views.outlook import population_z
from service.words.standouts import drift_stands_out, lot_stands_out

WORTH = 0.1
"""Tolerances a year: slower drifts are nobody's concern, however unlike the others they are."""


@dataclass(frozen=True)
class Standout:
    """A unit or a lot that drifts unlike the others of its type."""

    unit: str | None
    """Serial number; None for a lot."""
    text: str


def fleet_standouts(store: Store) -> tuple[Standout, ...]:
    """Of the whole fleet, in one query."""
    return standouts(store.outlooks.rates())


def standouts(rates: Sequence[Rate]) -> tuple[Standout, ...]:
    """Units first, the furthest out first; then lots."""
    placed = [(rate, z) for rate, z in zip(rates, population_z(rates), strict=True) if z is not None]
    out = standing_out([z for _, z in placed])
    units = [pair for pair, far in zip(placed, out, strict=True) if far and abs(pair[0].value) > WORTH]
    ordered = sorted(units, key=lambda pair: -abs(pair[1]))
    return (*(Standout(rate.serial, drift_stands_out(rate)) for rate, _ in ordered), *_lots(rates))


def _lots(rates: Sequence[Rate]) -> list[Standout]:
    groups: dict[tuple[str, str, str], list[Rate]] = {}
    for rate in rates:
        groups.setdefault((rate.unit_type, rate.kind, rate.parameter), []).append(rate)
    z = {
        (unit_type, parameter, lot): found
        for (unit_type, _, parameter), own in groups.items()
        if any(rate.lot for rate in own)
        for lot, found in group_standing([(r.value, r.sigma) for r in own], [r.lot or "" for r in own]).items()
        if len({rate.serial for rate in own if rate.lot == lot}) > 1
    }
    return [
        Standout(None, lot_stands_out(lot, unit_type, parameter))
        for (unit_type, parameter, lot), far in zip(z, standing_out(list(z.values())), strict=True)
        if far
    ]
