"""Everything that is known of stands: what units show of them, their certificates, flags, sessions and units."""

from dataclasses import dataclass

from service.flags.records import AT_FAULT, Flag
from service.flags.store import FlagQuery, Flags
from service.fleet.condition import UnitSummary
from service.fleet.records import FleetQuery, Order
from service.fleet.store import Fleet
from service.models.records import ModelRevision, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.sessions.records import SessionQuery, StoredSession
from service.sessions.store import Sessions
from service.stands.paper_records import StandCertificate
from service.stands.records import StandCondition, StandUse
from service.stands.store import StandCertificates, Stands
from service.storage.store import Store

MOST = 25
"""Flags, sessions and units that the page of one stand lists: a screen of each; the lists themselves have all."""


@dataclass(frozen=True)
class StandLine:
    """One stand in the list."""

    use: StandUse
    condition: StandCondition | None
    """None where no session tells of it."""
    certificates: tuple[StandCertificate, ...]
    """Oldest issue first."""
    flags: int
    """How many are open that find it at fault."""


@dataclass(frozen=True)
class StandReport:
    """One stand; one flag, unit or session more than are listed says that there are others."""

    line: StandLine
    flags: tuple[Flag, ...]
    units: tuple[UnitSummary, ...]
    """Whose latest session was measured on it, the latest first."""
    sessions: tuple[StoredSession, ...]
    """Newest first."""
    models: tuple[ModelRevision, ...]
    """Causes that engineers accepted into its model, and that hold."""


def every_stand(store: Store) -> tuple[StandLine, ...]:
    """All stands, by name, in three queries."""
    certificates, flags = StandCertificates(store).every(), Flags(store).open_about(*AT_FAULT)
    return tuple(
        StandLine(
            use=known.use,
            condition=known.condition,
            certificates=certificates.get(known.use.stand, ()),
            flags=sum(flag.place == known.use.stand for flag in flags),
        )
        for known in Stands(store).every()
    )


def stand_report(store: Store, name: str) -> StandReport:
    """One stand; NotFoundError where there is none of that name."""
    known = Stands(store).one(name)
    flags = Flags(store).page(FlagQuery(unresolved=True, stand=name, limit=MOST + 1))
    at_fault = sum(flag.matter in AT_FAULT for flag in flags)
    return StandReport(
        line=StandLine(known.use, known.condition, StandCertificates(store).of_stand(name), at_fault),
        flags=flags,
        units=Fleet(store).units(FleetQuery(stand=name, order=Order.LAST, backwards=True, limit=MOST + 1)),
        sessions=Sessions(store).wanted(SessionQuery(stand=name, limit=MOST + 1)),
        models=in_force(Models(store).of_subject(Scope.STAND, name)),
    )
