"""Everything that is known of unit types: tolerances and who set them, the nominal model, and their units."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from service.flags.records import Flag
from service.flags.store import FlagQuery, Flags
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery
from service.fleet.store import Fleet
from service.models.records import ModelRevision, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.storage.audit import Audit
from service.storage.store import Store
from service.types.records import ToleranceRevision, TypeUse, UnitType
from service.types.store import UnitTypes

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
    uses = UnitTypes(store).uses()
    return tuple(TypeLine(known, uses[known.name]) for known in UnitTypes(store).page(0, MOST_TYPES))


def type_report(store: Store, name: str) -> TypeReport:
    """One type; NotFoundError where there is none of that name."""
    unit_type = UnitTypes(store).get(name)
    revisions = UnitTypes(store).revisions(name)
    return TypeReport(
        line=TypeLine(unit_type, UnitTypes(store).uses(name)[name]),
        kinds=UnitTypes(store).kinds(name),
        revisions=revisions,
        setters=Audit(store).who_did("tolerances", name, [revision.since for revision in revisions]),
        flags=Flags(store).page(FlagQuery(unresolved=True, unit_type=name)),
        units=Fleet(store).units(FleetQuery(unit_type=name, limit=MOST + 1)),
        models=in_force(Models(store).of_subject(Scope.UNIT_TYPE, name)),
    )
