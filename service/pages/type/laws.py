"""Temperature laws common to the units of a type: learned from their sessions, put in force, taken back.

They hold like tolerances: from the next session on, with a revision of their own. So no verdict depends on sessions of
other units that arrived meanwhile.
"""

from collections.abc import Iterator
from dataclasses import asdict, replace
from datetime import datetime
from itertools import islice

import numpy as np

from estimator.groups.type_laws import UnitHistory, type_laws
from estimator.health.temperature_law import Seen
from estimator.health.type_law import TypeLaw
from estimator.health.warmth import ENOUGH_TO_BEND, WARMED
from estimator.message import say
from estimator.session import IN_SERVICE
from estimator.wording import counted
from service.errors import ConflictError
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.judging.reference import known_unit
from service.judging.temperature_words import in_degrees
from service.kit.measures import COVERAGE, YEAR, deviation_measure, heading, measured, number
from service.records.judge_again import MOST_LEARNED, places_of
from service.sessions.calibrations_store import Calibrations
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.rules import tolerances_of
from service.types.store import UnitTypes
from service.units.store import Units

MOST_LISTED = 500
"""Units of a type that are looked through, by serial number."""
MOST_UNITS = 50
"""Most units whose sessions are read: some ten seconds; further ones hardly change the result."""
NONE_IN_FORCE = "No temperature laws of this type are in force."
TOO_FEW = "Too few units: five with ten sensors in all, each measured six times at different temperatures, are needed."


def put_in_force(storage: Storage, name: str, now: datetime, *, who: str, why: str, wanted: bool = True) -> UnitType:
    """Learns a type's laws from the sessions accepted now, or takes them back; either is a revision of the type.

    ConflictError where too few units tell, or where there is nothing to take back.
    """
    laws = learned(storage, name) if wanted else ()
    with storage.database.writing() as store:
        current = UnitTypes(store).hold(name)
        if not laws and (wanted or not current.temperature_laws):
            raise ConflictError(TOO_FEW if wanted else NONE_IN_FORCE)
        new = UnitTypes(store).revise(replace(current, temperature_laws=laws, holds_before=False), now)
        Audit(store).write(
            now, who, "tolerances", name, {"why": why, "temperature_laws": [asdict(law) for law in laws]}
        )
    return new


def learned(storage: Storage, name: str) -> tuple[TypeLaw, ...]:
    """The temperature laws learned from the sessions that are accepted now; of measured units, or of simulated ones
    where there is no other.
    """
    with storage.database.reading() as store:
        known = UnitTypes(store).get(name)
        units = Fleet(store).units(FleetQuery(unit_type=name, order=Order.SERIAL, limit=MOST_LISTED, retired=None))
        real = [unit for unit in units if not unit.simulated] or units
        histories = tuple(islice((history for unit in real for history in _history(store, unit.serial)), MOST_UNITS))
    return type_laws(histories, tolerances_of(known))


def _history(store: Store, serial: str) -> Iterator[UnitHistory]:
    """The history of a unit's latest epoch, where its sessions were at different temperatures; else none."""
    places = [p for p in places_of(known_unit(store, Units(store).key(serial))) if p.session.programme != IN_SERVICE]
    reference = next((p.reference for p in reversed(places) if p.reference is not None), None)
    sessions = [p.session for p in places if reference is not None and p.reference is reference]
    warm = [(session, session.temperature) for session in sessions if session.temperature is not None][-MOST_LEARNED:]
    if reference is None or len(warm) < ENOUGH_TO_BEND or np.std([celsius for _, celsius in warm]) < WARMED:
        return
    made, start = Calibrations(store).in_force({reference.id, *(session.id for session, _ in warm)}), warm[0][0].at
    seen = [Seen((session.at - start) / YEAR, celsius, made[session.id]) for session, celsius in warm]
    yield UnitHistory(made[reference.id], seen)


def laws_in_words(known: UnitType) -> tuple[str, ...]:
    """``Bias, per °C at 22 °C: 1.0 ± 4.2 µg; …``: mean ± U of one more sensor of the type."""
    return tuple(map(_in_words, known.temperature_laws))


def _in_words(law: TypeLaw) -> str:
    measure = deviation_measure(law.kind, law.parameter, law.tolerance)
    slope, bend = (
        measured(mean * law.tolerance, COVERAGE * sigma * law.tolerance, measure)
        for mean, sigma in zip(law.mean, law.sigma, strict=True)
    )
    scatter = law.usual_scatter * law.tolerance
    return say(
        "{parameter}: {slope} per °C and {bend} per °C² at {about}, scatter {scatter}; from {units} with {sensors}.",
        parameter=heading(law.parameter),
        slope=slope,
        bend=bend,
        about=in_degrees(law.about),
        scatter=f"{number(scatter * measure.factor, 1)} {measure.label}",
        units=counted(law.units, "unit"),
        sensors=counted(law.sensors, "sensor"),
    )
