"""Unit types and their tolerances."""

from dataclasses import fields

from fastapi import APIRouter

from service.admission import PersonOf
from service.api.schemas.fields import TypeName, WindowOf
from service.api.schemas.problem import errors
from service.api.schemas.units import NewTolerances, TolerancesSchema, UnitTypePage
from service.dependencies import CREW, Now, Reading, SettingsOf, StorageOf
from service.flows.set_tolerances import set_tolerances
from service.records.tolerance_preview import TolerancePreview, WantedTolerances
from service.records.unit import Tolerances, UnitType
from service.views.tolerance_preview import preview_tolerances

router = APIRouter(prefix="/unit-types", tags=["unit types"])


@router.get("", responses=errors(422))
def list_unit_types(store: Reading, window: WindowOf) -> UnitTypePage:
    """Unit types, by name."""
    found = store.unit_types.page(window.offset, window.limit)
    return UnitTypePage(unit_types=found, **window.place(len(found)))


@router.get("/{name:path}", responses=errors(404, 422))
def read_unit_type(name: TypeName, store: Reading) -> UnitType:
    """One unit type with the tolerances that hold now."""
    return store.unit_types.get(name)


@router.put("/{name:path}", responses=errors(400, 404, 422))
def change_tolerances(name: TypeName, new: NewTolerances, storage: StorageOf, now: Now, person: PersonOf) -> UnitType:
    """Other tolerances, from the next session on, and another longest interval. Past decisions keep theirs."""
    gyro = None if new.gyro_tolerances is None else _record(new.gyro_tolerances)
    days, who = new.maximum_interval_days, person.signs(CREW)
    changed = set_tolerances(storage, name, _record(new.tolerances), gyro, now, interval_days=days, who=who)
    return changed


@router.post("/{name:path}/preview", responses=errors(400, 404, 422))
def preview_change(name: TypeName, new: NewTolerances, store: Reading, settings: SettingsOf) -> TolerancePreview:
    """What other tolerances would change: the latest sessions of the type's units, judged by them. Nothing is stored.

    At most 100 units are looked at, the worst first; `beyond` says how many were not.
    """
    gyro = None if new.gyro_tolerances is None else _record(new.gyro_tolerances)
    wanted = WantedTolerances(_record(new.tolerances), gyro)
    return preview_tolerances(store, name, wanted, settings.coverage_factor)


def _record(given: TolerancesSchema) -> Tolerances:
    return Tolerances(**{field.name: getattr(given, field.name) for field in fields(Tolerances)})
