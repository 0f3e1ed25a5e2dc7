"""When a unit must be calibrated next and why; the same of the whole fleet.

What is stored is worked out when a unit's history changes (`refresh_outlook`); read, it is only set against the clock
and against the rates of the type's other units.
"""

from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime

from estimator.health.population import standing
from service.errors import NotFoundError
from service.records.outlook import ParameterTrend, Rate, UnitOutlook
from service.storage import Storage
from service.storage.store import Store

FEWEST_UNITS = 3
"""Units of a type that make a population."""


def fleet_outlook(storage: Storage, now: datetime) -> tuple[UnitOutlook, ...]:
    """Every unit's outlook as it is now, by serial number; without fans and risk, which `outlook_of` has."""
    with storage.database.reading() as store:
        return outlooks_of_fleet(store, now)


def outlook_of(store: Store, serial: str, now: datetime) -> UnitOutlook:
    """One unit's outlook within a transaction."""
    own = store.outlooks.of_unit(serial)
    if own is None:
        if not store.units.exists(serial):
            raise NotFoundError(f"There is no unit {serial!r}.")
        return nothing_known(serial)
    return compared((own,), store.outlooks.rates(own.unit_type), now)[0]


def own_outlook(store: Store, serial: str, now: datetime) -> UnitOutlook | None:
    """One unit's outlook, not set against the others of its type; None before a session was judged."""
    own = store.outlooks.of_unit(serial)
    return None if own is None else replace(own, overdue=own.due is not None and own.due < now)


def outlooks_of_fleet(store: Store, now: datetime) -> tuple[UnitOutlook, ...]:
    """Every unit's outlook within a transaction, in two queries; without fans and risk, which `outlook_of` has."""
    return compared(store.outlooks.every(), store.outlooks.rates(), now)


def nothing_known(serial: str) -> UnitOutlook:
    """Of a unit whose sessions were judged before outlooks were kept."""
    reason = "No outlook yet: it is worked out with the next session."
    return UnitOutlook(serial, None, False, reason, None, None, None, None, None, ())


def compared(outlooks: Sequence[UnitOutlook], rates: Sequence[Rate], now: datetime) -> tuple[UnitOutlook, ...]:
    """Set against the clock, and every rate against those of the same parameter in other units of the type."""
    z = dict(zip(((r.serial, r.sensor, r.kind, r.parameter) for r in rates), population_z(rates), strict=True))

    def placed(serial: str, trend: ParameterTrend) -> ParameterTrend:
        return replace(trend, population_z=z.get((serial, trend.sensor, trend.kind, trend.parameter)))

    return tuple(
        replace(o, overdue=o.due is not None and o.due < now, trends=tuple(placed(o.serial, t) for t in o.trends))
        for o in outlooks
    )


def population_z(rates: Sequence[Rate]) -> list[float | None]:
    """How far each rate stands from the same parameter's in its type, in their robust spread; None with few units."""
    groups: dict[tuple[str, str, str], list[int]] = {}
    for place, rate in enumerate(rates):
        groups.setdefault((rate.unit_type, rate.kind, rate.parameter), []).append(place)
    found: list[float | None] = [None] * len(rates)
    for places in groups.values():
        if len({rates[place].serial for place in places}) >= FEWEST_UNITS:
            z = standing([(rates[place].value, rates[place].sigma) for place in places])
            for place, value in zip(places, z, strict=True):
                found[place] = value
    return found
