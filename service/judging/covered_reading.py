"""The temperatures that a unit's calibrations cover, read from the store."""

from estimator.health.temperature_law import NO_STEPS
from service.judging.covered import CoveredTemperatures, covered
from service.judging.reference import reference_of
from service.sessions.calibrations_store import Calibrations
from service.sessions.records import StoredSession
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.units.store import Units

MOST_EARLIER = 50
"""Sessions before one whose temperatures count: those of many years."""


def covered_at(store: Store, session: StoredSession) -> CoveredTemperatures | None:
    """By the unit's calibrations up to a session; None where there is no reference, or where its is not known."""
    unit, block = Units(store).key(session.unit), Sessions(store).block(session.id)
    found = reference_of(store, unit, block, session.programme, session.started_at)
    if found.session is None:
        return None
    earlier = Sessions(store).before(session, found.since, MOST_EARLIER)
    steps = Sessions(store).temperature_steps((session.id,)).get(session.id, NO_STEPS)
    return covered(Calibrations(store).get(found.session).residuals, (*earlier, session), steps)
