"""Everything that is known of one unit, apart from its history."""

from dataclasses import dataclass
from datetime import datetime

from estimator.session import CALIBRATIONS
from service.errors import NotFoundError
from service.fleet.condition import UnitSummary
from service.fleet.store import Fleet
from service.judging.covered import CoveredTemperatures
from service.judging.reference import covered_at
from service.kit.copying import copied
from service.outlook.records import UnitOutlook
from service.sessions.records import SessionQuery, StoredSession
from service.sessions.states import RecordState, StateChange
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.types.records import UnitType
from service.units.records import NO_EVENTS, Registered, Service, UnitEvents
from service.units.remarks_store import SaidOf


@dataclass(frozen=True)
class UnitReport:
    """Everything a unit's page or answer shows, apart from its history."""

    summary: UnitSummary
    unit_type: UnitType
    reference_session: str | None
    """Reference for the next session; None when that becomes the reference."""
    sessions: tuple[StoredSession, ...]
    """Latest sessions, newest first."""
    services: tuple[Service, ...]
    """All known breaks, oldest first."""
    withdrawn_services: tuple[Service, ...] = ()
    withdrawals: tuple[StateChange, ...] = ()
    """Withdrawals of these services: by whom, when and why."""
    waiting: int = 0
    """Sessions that are still to be judged again after a change of the records."""
    outlook: UnitOutlook | None = None
    """Outlook; None before a session was judged."""
    said: UnitEvents = NO_EVENTS
    entry: Registered | None = None
    """Entry in the register."""


def covered_now(store: Store, report: UnitReport) -> CoveredTemperatures | None:
    """The temperatures that the unit's calibrations cover; None before the first of its epoch, or where nothing says
    them."""
    latest = next((s for s in report.sessions if s.state is RecordState.ACCEPTED and s.programme in CALIBRATIONS), None)
    return None if latest is None or report.reference_session is None else covered_at(store, latest)


LATEST = 50
"""Sessions in the list and in the tables of a unit: some years of them."""


def unit_report(store: Store, serial: str, now: datetime) -> UnitReport:
    """The unit's condition, type, latest sessions and known breaks."""
    known = Fleet(store).unit_known(serial, now)
    if known is None:
        raise NotFoundError("There is no unit {serial}.", serial=repr(serial))
    said = SaidOf(store).unit(serial)
    return copied(
        UnitReport,
        known,
        sessions=Sessions(store).wanted(SessionQuery(unit=serial, limit=LATEST)),
        services=tuple(s for s in said.services if s.state is RecordState.ACCEPTED),
        withdrawn_services=tuple(s for s in said.services if s.state is RecordState.WITHDRAWN),
        withdrawals=said.withdrawals,
        said=said,
    )
