"""Everything that is known of one unit, apart from its history."""

from datetime import datetime

from estimator.session import PROGRAMMES
from service.errors import NotFoundError
from service.records.state import RecordKind, RecordState
from service.records.unit import UnitReport
from service.storage.queries.services import epoch
from service.storage.store import Store

LATEST = 50
"""Sessions in the list of a unit: some years of them."""


def unit_report(store: Store, serial: str, now: datetime) -> UnitReport:
    """The unit's condition, type, latest sessions and known breaks."""
    found = store.fleet.unit_with_type(serial)
    if found is None:
        raise NotFoundError(f"There is no unit {serial!r}.")
    summary, unit_type = found
    unit = store.units.key(serial)
    recorded = store.services.recorded(serial)
    services = tuple(s for s in recorded if s.state is RecordState.ACCEPTED)
    withdrawn = tuple(s for s in recorded if s.state is RecordState.WITHDRAWN)
    since, until = epoch(tuple(service.at for service in services), now)
    return UnitReport(
        summary=summary,
        unit_type=unit_type,
        reference_session=store.sessions.reference(unit, unit_type.block, since, until, PROGRAMMES),
        sessions=store.sessions.page(serial, 0, LATEST),
        services=services,
        withdrawn_services=withdrawn,
        withdrawals=tuple(store.states.last_of(RecordKind.SERVICE, tuple(str(s.id) for s in withdrawn)).values()),
        waiting=store.derivations.waiting_of(serial),
    )
