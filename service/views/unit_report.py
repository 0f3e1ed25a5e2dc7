"""Everything that is known of one unit, apart from its history."""

from datetime import datetime

from service.errors import NotFoundError
from service.records.state import RecordState
from service.records.unit import UnitReport
from service.storage.store import Store

LATEST = 50
"""Sessions in the list of a unit: some years of them."""


def unit_report(store: Store, serial: str, now: datetime) -> UnitReport:
    """The unit's condition, type, latest sessions and known breaks."""
    known = store.fleet.unit_known(serial, now)
    if known is None:
        raise NotFoundError(f"There is no unit {serial!r}.")
    said = store.said_of.unit(serial)
    return UnitReport(
        summary=known.summary,
        unit_type=known.unit_type,
        reference_session=known.reference_session,
        sessions=store.sessions.page(serial, 0, LATEST),
        services=tuple(s for s in said.services if s.state is RecordState.ACCEPTED),
        withdrawn_services=tuple(s for s in said.services if s.state is RecordState.WITHDRAWN),
        withdrawals=said.withdrawals,
        waiting=known.waiting,
        outlook=known.outlook,
        said=said,
    )
