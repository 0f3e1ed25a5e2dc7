"""Step: before a session is judged or stored: a unit's sessions are all measured, or all simulated.

What was simulated says nothing of hardware: it must not move a measured unit's verdict, due date, flags or forecasts.
"""

from estimator.errors import FormatError, Problem
from estimator.message import say
from estimator.session import CalibrationSession
from service.sessions.store import Sessions
from service.storage.store import Store
from service.units.store import Units

OTHERS_MEASURED = (
    "this session is simulated, and the sessions of unit {unit} were measured; the two are never mixed: give the "
    "simulated unit a serial number of its own"
)
OTHERS_SIMULATED = (
    "this session was measured, and the sessions of unit {unit} are simulated; the two are never mixed: withdraw the "
    "simulated ones, or give this unit a serial number of its own"
)


def require_one_origin(store: Store, session: CalibrationSession) -> bool:
    """FormatError where the session is simulated and its unit's others are measured, or the other way round.

    A unit whose simulated sessions were all withdrawn may be measured: somebody had tried out its serial number. True
    where it is measured from now on.
    """
    known = Units(store).is_simulated(session.unit)
    if known is None or known == session.is_simulated:
        return False
    if session.is_simulated:
        raise FormatError([Problem("origin", say(OTHERS_MEASURED, unit=session.unit))])
    if Sessions(store).any_stands(session.unit):
        raise FormatError([Problem("origin", say(OTHERS_SIMULATED, unit=session.unit))])
    return True
