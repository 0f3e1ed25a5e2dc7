"""Everything that is known of one unit, apart from its history."""

from datetime import datetime

from service.errors import NotFoundError
from service.records.state import RecordKind, RecordState
from service.records.unit import UnitReport
from service.storage.store import Store

LATEST = 50
"""Sessions in the list of a unit: some years of them."""


def unit_report(store: Store, serial: str, now: datetime) -> UnitReport:
    """The unit's condition, type, latest sessions and known breaks."""
    known = store.fleet.unit_known(serial, now)
    if known is None:
        raise NotFoundError(f"There is no unit {serial!r}.")
    recorded = store.services.recorded(serial)
    withdrawn = tuple(s for s in recorded if s.state is RecordState.WITHDRAWN)
    return UnitReport(
        summary=known.summary,
        unit_type=known.unit_type,
        reference_session=known.reference_session,
        sessions=store.sessions.page(serial, 0, LATEST),
        services=tuple(s for s in recorded if s.state is RecordState.ACCEPTED),
        withdrawn_services=withdrawn,
        withdrawals=tuple(store.states.last_of(RecordKind.SERVICE, tuple(str(s.id) for s in withdrawn)).values()),
        waiting=known.waiting,
        outlook=known.outlook,
    )
