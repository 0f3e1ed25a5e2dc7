"""Everything that is known of unit types: tolerances and who set them, the nominal model, and their units."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from service.judging.model_in_force import in_force
from service.records.flag import Flag
from service.records.fleet import FleetQuery
from service.records.model import ModelRevision, Scope
from service.records.unit import ToleranceRevision, TypeUse, UnitSummary, UnitType
from service.storage.queries.flags import FlagQuery
from service.storage.store import Store

MOST_TYPES = 500
"""In the list: no maker has more kinds of unit."""
MOST = 25
"""Units that the page of one type lists: a screen; the fleet's page has all."""


@dataclass(frozen=True)
class TypeLine:
    """One type in the list."""

    unit_type: UnitType
    use: TypeUse


@dataclass(frozen=True)
class TypeReport:
    """One type; one unit more than are listed says that there are others."""

    line: TypeLine
    kinds: Mapping[str, str]
    """Of its sensors, where a session told."""
    revisions: tuple[ToleranceRevision, ...]
    """Of its tolerances, oldest first."""
    setters: Mapping[datetime, str]
    """Who set the tolerances, by when; the first ones nobody did."""
    flags: tuple[Flag, ...]
    """Open ones on what its sessions show together."""
    units: tuple[UnitSummary, ...]
    """Worst first."""
    models: tuple[ModelRevision, ...]
    """Causes that engineers accepted into its model, and that hold."""


def every_type(store: Store) -> tuple[TypeLine, ...]:
    """All types, by name, in two queries."""
    uses = store.unit_types.uses()
    return tuple(TypeLine(known, uses[known.name]) for known in store.unit_types.page(0, MOST_TYPES))


def type_report(store: Store, name: str) -> TypeReport:
    """One type; NotFoundError where there is none of that name."""
    unit_type = store.unit_types.get(name)
    revisions = store.unit_types.revisions(name)
    return TypeReport(
        line=TypeLine(unit_type, store.unit_types.uses(name)[name]),
        kinds=store.unit_types.kinds(name),
        revisions=revisions,
        setters=store.audit.who_did("tolerances", name, [revision.since for revision in revisions]),
        flags=store.flags.page(FlagQuery(unresolved=True, unit_type=name)),
        units=store.fleet.units(FleetQuery(unit_type=name, limit=MOST + 1)),
        models=in_force(store.models.of_subject(Scope.UNIT_TYPE, name)),
    )
