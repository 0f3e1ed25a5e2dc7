"""Everything that is known of one unit, apart from its history."""

from datetime import datetime

from estimator.message import say
from service.errors import NotFoundError
from service.fleet.store import Fleet
from service.pages.unit.records import UnitReport
from service.sessions.states import RecordState
from service.sessions.store import Sessions
from service.storage.store import Store
from service.units.remarks_store import SaidOf

LATEST = 50
"""Sessions in the list of a unit: some years of them."""


def unit_report(store: Store, serial: str, now: datetime) -> UnitReport:
    """The unit's condition, type, latest sessions and known breaks."""
    known = Fleet(store).unit_known(serial, now)
    if known is None:
        raise NotFoundError(say("There is no unit {serial}.", serial=repr(serial)))
    said = SaidOf(store).unit(serial)
    return UnitReport(
        summary=known.summary,
        unit_type=known.unit_type,
        reference_session=known.reference_session,
        sessions=Sessions(store).page(serial, 0, LATEST),
        services=tuple(s for s in said.services if s.state is RecordState.ACCEPTED),
        withdrawn_services=tuple(s for s in said.services if s.state is RecordState.WITHDRAWN),
        withdrawals=said.withdrawals,
        waiting=known.waiting,
        outlook=known.outlook,
        said=said,
    )
