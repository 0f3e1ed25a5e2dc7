"""The date and the reason of a unit's next calibration.

`refresh_outlook` works out the stored part when a unit's history changes; `summarise` only compares it with the clock
and with the stored rates of its type.
"""

from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime

from service.kit.failure import unit_failed
from service.outlook.populations import Population
from service.outlook.records import ParameterTrend, UnitOutlook
from service.outlook.store import Outlooks, Populations
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.storage.queries import Store
from service.units.store import Units


def outlook_of(store: Store, serial: str, now: datetime) -> UnitOutlook:
    """One unit's outlook within a transaction."""
    known = Outlooks(store).of_unit(serial)
    if known is None:
        Units(store).key(serial)
        known = nothing_known(serial)
    why = WorkQueue(store, WorkKind.OUTLOOK).failed(serial)
    return replace(
        compared(known, Populations(store).of_type(known.unit_type), now), failed=unit_failed(why) if why else ""
    )


def dated(outlook: UnitOutlook | None, now: datetime) -> UnitOutlook | None:
    """Set against the clock alone, and not against the others of its type."""
    return None if outlook is None else compared(outlook, (), now)


def nothing_known(serial: str) -> UnitOutlook:
    """The outlook of a unit whose sessions were judged before outlooks were kept."""
    reason = "No outlook yet: it is computed with the next session."
    return UnitOutlook(serial, None, False, reason, None, None, None, None, None, ())


def compared(outlook: UnitOutlook, populations: Iterable[Population], now: datetime) -> UnitOutlook:
    """Set against the clock, and every rate against those of the same parameter in other units of the type."""
    known = {(population.kind, population.parameter): population for population in populations if population.rates}
    trends = tuple(_placed(trend, known.get((trend.kind, trend.parameter))) for trend in outlook.trends)
    return replace(outlook, overdue=outlook.due is not None and outlook.due < now, trends=trends)


def _placed(trend: ParameterTrend, among: Population | None) -> ParameterTrend:
    """The trend with its distance among the rates of the type, compared in tolerances a year."""
    if among is None:
        return trend
    z = among.z(trend.rate_per_year / trend.tolerance, trend.rate_sigma / trend.tolerance)
    return replace(trend, population_z=z)
