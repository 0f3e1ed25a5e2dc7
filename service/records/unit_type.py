"""Flow: a unit is moved to another type. Everything derived of it is then as if it had always been of that type."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace

from estimator.errors import problem_at
from estimator.message import joined, say
from estimator.session import ACCELEROMETER, GYROSCOPE
from estimator.wording import counted
from service.errors import ConflictError, RefusedError
from service.fleet.changes import ask_for_summaries
from service.groups.store import Groups
from service.ingest.names import fault_of_name
from service.judging.store import Derivations
from service.models.records import Scope
from service.models.rules import in_force
from service.models.store import Models
from service.queue.records import WorkKind
from service.queue.store import WorkQueue
from service.records.derive_again import Deriving, derive_again
from service.records.follow import follow
from service.records.recalibrate import recalibrate
from service.sessions.states import Step
from service.storage import Storage
from service.storage.audit import Audit
from service.storage.queries import Store
from service.types.records import UnitType
from service.types.rules import DEFAULTS
from service.types.store import UnitTypes
from service.units.store import Units

KINDS = {ACCELEROMETER: "accelerometer", GYROSCOPE: "gyro"}


def set_type(storage: Storage, context: Deriving, serial: str, name: str, step: Step) -> UnitType:
    """Moves a unit to a type, a new one where there is none of that name; the same one again changes nothing.

    RefusedError where the sensors of the type are others than the unit's, ConflictError where its sessions hold causes
    that were accepted for the type that it has.
    """
    with storage.database.writing() as store:
        unit = Units(store).hold(serial)
        was = UnitTypes(store).of_unit(serial)
        if name == was.name:
            return was
        UnitTypes(store).add_once(_like(was, name), step.at)
        _require_possible(store, serial, was, UnitTypes(store).get(name))
        ask_for_all(store, serial, context)
        Units(store).set_type(unit, name)
        ask_for_all(store, serial, context)
        Audit(store).write(step.at, step.who, "type", serial, {"before": was.name, "type": name, "why": step.why})
        sessions = Derivations(store).counted(unit)
        Derivations(store).wait([session.id for session in sessions])
        derived = derive_again(store, context, serial, sessions[0].at) if sessions else None
    if derived is not None:
        follow(storage, context, serial, derived)
        recalibrate(storage, serial, step.at, coverage_factor=context.coverage_factor, who=step.who)
    with storage.database.reading() as store:
        return UnitTypes(store).of_unit(serial)


def ask_for_all(store: Store, serial: str, context: Deriving) -> None:
    """Asks for the joint diagnosis and the statistics of a unit's type, as it is at the moment."""
    ask_for_summaries(store, serial, context.at)
    WorkQueue(store, WorkKind.GROUP).enqueue_each((group.place for group in Groups(store).of_unit(serial)), context.at)


def _like(was: UnitType, name: str) -> UnitType:
    """A type of the same sensors without tolerances of its own."""
    gyro = None if was.gyro_tolerances is None else DEFAULTS[GYROSCOPE]
    first = replace(was, name=name, revision=1, gyro_tolerances=gyro, temperature_laws=(), are_entered=False)
    return replace(first, tolerances=DEFAULTS[was.block]) if was.block else first


def _require_possible(store: Store, serial: str, was: UnitType, new: UnitType) -> None:
    fault = fault_of_name(new.name)
    kinds, own = UnitTypes(store).kinds(new.name), UnitTypes(store).kinds_of_unit(serial)
    theirs = Counter(kinds.get(name, new.block) if kinds else "sensor" for name in new.sensors)
    ours = Counter(own.values() if kinds else ["sensor"] * len(own))
    if not fault and ours and theirs and ours != theirs:
        parts = {"theirs": _in_words(theirs), "serial": serial, "ours": _in_words(ours)}
        fault = say("is of units with {theirs}; {serial} has {ours}: name a type with the same sensors", **parts)
    if fault:
        raise RefusedError("The unit cannot be moved to that type.", (problem_at("unit_type", fault),))
    if in_force(Models(store).of_subject(Scope.UNIT_TYPE, was.name)):
        raise ConflictError(
            "The sessions of {serial} hold causes that were accepted for its type {type}: withdraw them first.",
            serial=serial,
            type=was.name,
        )


def _in_words(kinds: Mapping[str, int]) -> str:
    return joined(" and ", (counted(kinds[kind], KINDS.get(kind, kind)) for kind in sorted(kinds)))
