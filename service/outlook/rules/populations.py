"""Drift of the units of a type, parameter by parameter: centre and spread of their rates, and the units far out.

A type of thousands of units is evaluated once for many pages, which read a few numbers and the furthest few.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from estimator.health.population import group_standing, outliers, spread, standing
from service.outlook.populations import Placed, Population
from service.outlook.records import Rate
from service.outlook.store import FarOut, Populations
from service.outlook.words import drift_stands_out, lot_stands_out
from service.storage.queries import Store

FEWEST_UNITS = 3
"""Units of a type that make a population."""
WORTH = 0.1
"""Tolerances a year: slower drifts are nobody's concern, however unlike the others they are."""
SIGNIFICANT = 0.001
"""The chance of such a rate without a drift, beyond which it is no matter for paper."""
KEPT = 8
"""The furthest of each population that are kept: more than any page or paper names of all of them."""
Group = list[Rate]


def populations(rates: Sequence[Rate]) -> tuple[Population, ...]:
    """The populations of the rates of one type."""
    groups: dict[tuple[str, str], Group] = {}
    for rate in rates:
        groups.setdefault((rate.kind, rate.parameter), []).append(rate)
    found = (_population(*place, group) for place, group in sorted(groups.items()))
    return tuple(population for population in found if population.rates or population.lots)


def _population(kind: str, parameter: str, group: Group) -> Population:
    values, sigmas = np.array([(rate.value, rate.sigma) for rate in group]).T
    centre, wide = spread(values, sigmas)
    is_one = len({rate.serial for rate in group}) >= FEWEST_UNITS
    z = standing(values, sigmas, centre, wide)
    placed = [_placed(group[i], float(z[i])) for i in np.argsort(-np.abs(z), kind="stable")] if is_one else []
    lots = sorted(_lots(group), key=lambda lot: -abs(lot[1]))
    return Population(
        unit_type=group[0].unit_type,
        kind=kind,
        parameter=parameter,
        centre=centre,
        spread=wide,
        rates=len(placed),
        lots=len(lots),
        fast=_first(rate for rate, _ in placed if abs(rate.value) > WORTH),
        evident=_first(rate for rate, chance in placed if chance < SIGNIFICANT),
        far_lots=tuple(lots[:KEPT]),
    )


def _placed(rate: Rate, z: float) -> tuple[Placed, float]:
    """The rate at its distance, with the chance of such a rate without a drift."""
    return Placed(rate.serial, rate.sensor, rate.value, rate.sigma, z, rate.tolerance), rate.significance


def _first(found: Iterator[Placed]) -> tuple[Placed, ...]:
    return tuple(rate for rate, _ in zip(found, range(KEPT), strict=False))


def _lots(group: Group) -> list[tuple[str, float]]:
    """Lots of several units and their distances."""
    if not any(rate.lot for rate in group):
        return []
    units: dict[str, set[str]] = {}
    for rate in group:
        units.setdefault(rate.lot or "", set()).add(rate.serial)
    z = group_standing([(rate.value, rate.sigma) for rate in group], [rate.lot or "" for rate in group])
    return [(lot, far) for lot, far in z.items() if len(units[lot]) > 1]


@dataclass(frozen=True)
class Standout:
    """A unit or a lot that drifts unlike the others of its type."""

    unit: str | None
    """Serial number; None for a lot."""
    text: str


def fleet_standouts(store: Store, most: int) -> tuple[Standout, ...]:
    """The units and lots furthest out in the whole fleet, in one query."""
    return standouts(Populations(store).furthest(most))[:most]


def standouts(far: FarOut) -> tuple[Standout, ...]:
    """Units first, the furthest out first; then lots."""
    return (*_units(far), *_far_lots(far))


def _units(far: FarOut) -> list[Standout]:
    placed = [(rate, population) for population in far.populations for rate in population.fast]
    placed.sort(key=lambda pair: -abs(pair[0].z))
    out = outliers([rate.z for rate, _ in placed], among=far.rates)
    return [_unit(*pair) for pair, is_out in zip(placed, out, strict=True) if is_out]


def _unit(rate: Placed, population: Population) -> Standout:
    return Standout(rate.serial, drift_stands_out(rate.sensor, population.parameter, rate.value))


def _far_lots(far: FarOut) -> list[Standout]:
    lots = [(*lot, population) for population in far.populations for lot in population.far_lots]
    out = outliers([z for _, z, _ in lots], among=far.lots)
    return [
        Standout(None, lot_stands_out(lot, population.unit_type, population.parameter))
        for (lot, _, population), is_out in zip(lots, out, strict=True)
        if is_out
    ]
