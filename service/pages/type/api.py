"""Unit types and their tolerances."""

from dataclasses import fields

from fastapi import APIRouter
from pydantic import Field

from service.pages.type.laws import put_in_force
from service.pages.type.proposal import proposed
from service.pages.type.tolerances import Watch, preview_tolerances, set_tolerances
from service.pages.unit.schemas import NewTolerances, TolerancesSchema, UnitTypePage
from service.people.admission import PersonOf
from service.people.dependencies import CREW, StorageOf
from service.types.records import TolerancePreview, Tolerances, UnitType, WantedTolerances
from service.types.store import UnitTypes
from service.web.dependencies import Now, Reading, SettingsOf
from service.web.fields import Body, Name, Reason, TypeName, WindowOf
from service.web.problem_document import errors

router = APIRouter(prefix="/unit-types", tags=["unit types"])


@router.get("", responses=errors(422))
def list_unit_types(store: Reading, window: WindowOf) -> UnitTypePage:
    """Unit types, by name."""
    found = UnitTypes(store).page(window.offset, window.limit)
    return UnitTypePage(unit_types=found, **window.place(len(found)))


class WantedTypeLaws(Body):
    """Whether a type's temperature laws are to hold."""

    in_force: bool = Field(description="True learns them anew from the sessions accepted now; false takes them back.")
    by: Name = Field(description="Who says so.")
    why: Reason = Field(description="Why.")


@router.put("/{name:path}/temperature-laws", responses=errors(400, 404, 409, 422))
def set_type_laws(name: TypeName, new: WantedTypeLaws, storage: StorageOf, now: Now, person: PersonOf) -> UnitType:
    """Learn them from the type's sessions, or take them back: from the next session on, with a revision of the type.

    409 where fewer than five units with ten sensors were measured six times at different temperatures.
    """
    return put_in_force(storage, name, now, who=person.signs(new.by), why=new.why, wanted=new.in_force)


@router.get("/{name:path}/proposal", responses=errors(404, 422))
def propose(name: TypeName, store: Reading) -> WantedTolerances:
    """Tolerances that the calibrations of the type's units keep so far, for a person to confirm; nothing is stored."""
    return proposed(store, UnitTypes(store).get(name))


@router.get("/{name:path}", responses=errors(404, 422))
def read_unit_type(name: TypeName, store: Reading) -> UnitType:
    """One unit type with the tolerances that hold now."""
    return UnitTypes(store).get(name)


@router.put("/{name:path}", responses=errors(400, 404, 422))
def change_tolerances(name: TypeName, new: NewTolerances, storage: StorageOf, now: Now, person: PersonOf) -> UnitType:
    """Other tolerances, from the next session on; another longest interval or share of the tolerance that has a flag,
    at once. Past decisions keep theirs unless `stored_sessions` is true."""
    gyro = None if new.gyro_tolerances is None else _record(new.gyro_tolerances)
    watch = Watch(new.maximum_interval_days, new.flag_share)
    limits, who = (_record(new.tolerances), gyro), person.signs(CREW)
    return set_tolerances(storage, name, *limits, now, watch=watch, who=who, stored=new.stored_sessions)


@router.post("/{name:path}/preview", responses=errors(400, 404, 422))
def preview_change(name: TypeName, new: NewTolerances, store: Reading, settings: SettingsOf) -> TolerancePreview:
    """The effect of other tolerances: the latest sessions of the type's units, judged by them. Nothing is stored.

    At most 100 units are examined, the worst first; `beyond` gives the number of the others.
    """
    gyro = None if new.gyro_tolerances is None else _record(new.gyro_tolerances)
    wanted = WantedTolerances(_record(new.tolerances), gyro)
    return preview_tolerances(store, name, wanted, settings.coverage_factor)


def _record(given: TolerancesSchema) -> Tolerances:
    return Tolerances(**{field.name: getattr(given, field.name) for field in fields(Tolerances)})
