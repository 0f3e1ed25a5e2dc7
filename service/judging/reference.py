"""Step: which session another is judged against: the reference of its block in its epoch.

An epoch lasts from one known break in the unit's history, a service, to the next; what is measured at the moment of the
service is after it. Its reference is the first session that was kept as one. Calibrations have one reference together,
alignments and rate tables one each; a recording in service never becomes one and is compared with the calibrations'.
"""

from dataclasses import dataclass
from datetime import datetime

from estimator.errors import Problem, ScheduleError
from estimator.message import say
from estimator.results import Calibration
from estimator.session import CALIBRATIONS, IN_SERVICE, comparable
from service.ingest.checked import Checked
from service.sessions.calibrations_store import Calibrations
from service.sessions.store import Sessions
from service.storage.store import Store
from service.units.store import Services, Units


@dataclass(frozen=True)
class Reference:
    """What a session of an epoch is judged against."""

    session: str | None
    """Its id; None where the epoch has no reference yet."""
    since: datetime | None
    """Of the service that the epoch began with; None in a unit's first epoch."""


def reference_of(store: Store, unit: int, block: str, programme: str, at: datetime) -> Reference:
    """The reference for a session of a block of the unit, by what was measured and when."""
    since, until = Services(store).around(unit, at)
    return Reference(Sessions(store).reference(unit, block, since, until, alike(programme)), since)


def alike(programme: str) -> tuple[str, ...]:
    """Programmes whose sessions a session is judged against; a recording in service against the calibrations'."""
    return CALIBRATIONS if programme == IN_SERVICE else comparable(programme)


def calibration_to_compare_with(store: Store, recording: Checked) -> Calibration:
    """The calibration of the epoch that a recording in service was made in; ScheduleError where there is none yet."""
    session = recording.session
    if not Units(store).exists(session.unit):
        raise _uncalibrated(session.unit, None)
    unit = Units(store).key(session.unit)
    found = reference_of(store, unit, session.block, session.programme, recording.measured_at)
    if found.session is None:
        raise _uncalibrated(session.unit, found.since)
    return Calibrations(store).get(found.session)


def _uncalibrated(unit: str, since: datetime | None) -> ScheduleError:
    """That the unit has no calibration, and what to do first."""
    service = "" if since is None else say(" since its service of {since}", since=f"{since:%Y-%m-%d}")
    message = say(
        "{unit} has no calibration yet{service}, and a recording in service is compared with "
        "one: upload a calibration session of the unit first, then this file again",
        unit=unit,
        service=service,
    )
    return ScheduleError([Problem("unit", message)])
