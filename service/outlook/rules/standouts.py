"""Units and production lots whose drift stands out of their type, at one level for the whole fleet."""

from dataclasses import dataclass

from estimator.health.population import outliers
from service.outlook.populations import Placed, Population
from service.outlook.populations_store import FarOut, Populations
from service.outlook.words.standouts import drift_stands_out, lot_stands_out
from service.storage.store import Store


@dataclass(frozen=True)
class Standout:
    """A unit or a lot that drifts unlike the others of its type."""

    unit: str | None
    """Serial number; None for a lot."""
    text: str


def fleet_standouts(store: Store, most: int) -> tuple[Standout, ...]:
    """The first of the whole fleet, in one query."""
    return standouts(Populations(store).furthest(most))[:most]


def standouts(far: FarOut) -> tuple[Standout, ...]:
    """Units first, the furthest out first; then lots."""
    return (*_units(far), *_lots(far))


def _units(far: FarOut) -> list[Standout]:
    placed = [(one, population) for population in far.populations for one in population.fast]
    placed.sort(key=lambda pair: -abs(pair[0].z))
    out = outliers([one.z for one, _ in placed], among=far.rates)
    return [_unit(*pair) for pair, is_out in zip(placed, out, strict=True) if is_out]


def _unit(one: Placed, population: Population) -> Standout:
    return Standout(one.serial, drift_stands_out(one.sensor, population.parameter, one.value))


def _lots(far: FarOut) -> list[Standout]:
    lots = [(*lot, population) for population in far.populations for lot in population.far_lots]
    out = outliers([z for _, z, _ in lots], among=far.lots)
    return [
        Standout(None, lot_stands_out(lot, population.unit_type, population.parameter))
        for (lot, _, population), is_out in zip(lots, out, strict=True)
        if is_out
    ]
