"""Step: a session → the one that it is judged against: the reference of its block in its epoch.

An epoch lasts from one known break in the unit's history, a service, to the next; a session at the moment of the
service is after it. Its reference is the first session that was kept as one. Calibrations have one reference together,
alignments and rate tables one each; a recording in service never becomes one and is compared with the calibrations'.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import datetime

from estimator.codec import UnreadableError
from estimator.errors import Problem, ScheduleError
from estimator.health.rule import tolerance_of
from estimator.message import say
from estimator.results import Calibration
from estimator.session import CALIBRATIONS, IN_SERVICE, comparable
from service.ingest.checked import Checked
from service.judging.covered import CoveredTemperatures, covered
from service.judging.covered_store import Covering
from service.judging.records import Counted, UnitRecords
from service.judging.store import Derivations
from service.sessions.calibrations_store import Calibrations, calibration_of
from service.sessions.expanded import expanded_of
from service.sessions.records import PARAMETERS, StoredSession
from service.sessions.store import Sessions
from service.sessions.words.advice import too_few
from service.storage.queries import Store
from service.units.store import Services, Units, epoch

MOST_EARLIER = 50
"""Sessions before one whose temperatures count: those of many years."""
NOTHING_READ: Mapping[tuple[str, int], Calibration] = {}


@dataclass(frozen=True)
class KnownUnit:
    """A unit's records, and the calibrations of its sessions that were asked for."""

    store: Store
    unit: int
    records: UnitRecords
    made: dict[str, Calibration] = field(default_factory=dict)
    """Calibrations that this transaction stores: nothing was decided of them before."""
    read: dict[str, Calibration] = field(default_factory=dict)
    """Calibrations in force that it has read."""
    files: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """Files of sessions that are not stored yet: hash and name by id."""

    def calibration(self, id: str) -> Calibration:
        """The calibration in force of a session."""
        if id in self.made:
            return self.made[id]
        if id not in self.read:
            self.read[id] = Calibrations(self.store).get(id)
        return self.read[id]

    def file(self, id: str) -> tuple[str, str]:
        """The hash and the name of a session's file."""
        if id in self.files:
            return self.files[id]
        session = Sessions(self.store).get(id)
        return session.sha256, session.filename

    def read_all(self, ids: Collection[str]) -> None:
        """Reads those of several sessions at once."""
        unread = {*ids} - self.made.keys() - self.read.keys()
        if len(unread) > 1:
            self.read.update(Calibrations(self.store).in_force(unread))

    def is_blind(self, session: Counted) -> bool:
        """Whether a session gives no uncertainty; a reference gave one when it was taken for it."""
        return not session.is_reference and bool(too_few(self.calibration(session.id)))

    def reference(self, block: str, programme: str, at: datetime) -> str | None:
        """The session that one of a block, programme and time is judged against."""
        since, until = epoch(self.records.breaks, at)
        return next(
            (
                counted.id
                for counted in self.records.counted
                if counted.is_reference
                and (counted.block, counted.programme in alike(programme)) == (block, True)
                and (since is None or counted.at >= since)
                and (until is None or counted.at < until)
            ),
            None,
        )


def known_unit(
    store: Store,
    unit: int,
    made: dict[str, Calibration] | None = None,
    references: Mapping[tuple[str, int], Calibration] = NOTHING_READ,
) -> KnownUnit:
    """A unit as its rows are now, with calibrations that were stored just before, and with those of references that
    were read already, by session and revision."""
    records = Derivations(store).records(unit)
    current = {(counted.id, counted.revision) for counted in records.counted}
    read = {id: found for (id, revision), found in references.items() if (id, revision) in current}
    return KnownUnit(store, unit, records, made or {}, read)


@dataclass(frozen=True)
class EpochReference:
    """Reference of an epoch."""

    session: str | None
    """Id of the reference; None where the epoch has none yet."""
    since: datetime | None
    """Time of the service with which the epoch began, UTC; None in a unit's first epoch."""


def reference_of(store: Store, unit: int, block: str, programme: str, at: datetime) -> EpochReference:
    """The reference for a session of a block of the unit, by what was measured and when."""
    since = Services(store).began(unit, at)
    return EpochReference(Sessions(store).reference(unit, block, at, alike(programme)), since)


def covered_at(store: Store, session: StoredSession) -> CoveredTemperatures | None:
    """The temperatures covered by the unit's calibrations up to a session; None where there is no reference, or where
    its temperature is not known.
    """
    found = Covering(store).up_to(session, alike(session.programme), MOST_EARLIER)
    if found.reference is None:
        return None
    try:
        residuals = calibration_of(found.reference).residuals
    except UnreadableError:  # a damaged document costs the session's page this range, not the page
        return None
    judged = session.temperature, session.verdict
    return covered(residuals, (*found.measured, judged), found.steps)


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
    """The error that the unit has no calibration, with the remedy."""
    service = "" if since is None else say(" since its service of {date}", date=f"{since:%Y-%m-%d}")
    message = say(
        "{unit} has no calibration{service} to compare a recording in service with: upload a calibration session "
        "first, then this file again",
        unit=unit,
        service=service,
    )
    return ScheduleError([Problem("unit", message)])


def left_uncertain(
    calibration: Calibration, tolerances: Mapping[tuple[str, str], float], coverage_factor: float
) -> Iterator[str]:
    """``A1 scale``: every parameter that has a tolerance and is not known to it."""
    for sensor in calibration.sensors:
        for parameter in PARAMETERS:
            tolerance = tolerance_of(tolerances, sensor.name, sensor.kind, parameter)
            if tolerance is None or parameter not in sensor.observable:
                continue
            expanded = expanded_of(sensor, parameter, coverage_factor)
            if expanded is None or expanded > tolerance:
                yield say("{name} {parameter}", name=sensor.name, parameter=parameter)
