"""Step: a diagnosis → its effect on the session's verdict: the verdict with the named causes, and the reservations."""

from dataclasses import dataclass, field, replace
from datetime import datetime

from estimator.errors import SessionError
from estimator.health.temperature_law import Steps
from estimator.session import CalibrationSession
from service.diagnosis.records import Diagnosed
from service.diagnosis.store import Diagnoses
from service.ingest import read_upload
from service.judging.cause_sizes import Yardstick
from service.judging.records import Counted
from service.judging.reference import MOST_EARLIER, reference_of
from service.judging.reservations import (
    UNCHECKED,
    Basis,
    Covered,
    Doubted,
    Otherwise,
    covered_by,
    reservations_at,
    reservations_of,
    verdicts_under_alternatives,
    worth_at,
)
from service.judging.store import Derivations
from service.kit.lock_order import outside_writing
from service.models.rules import in_force, places_of
from service.models.store import Models
from service.outlook.store import Outlooks
from service.sessions.calibrations_store import Calibrations
from service.sessions.decision import Verdict, nominal_factor_of, steps_in
from service.sessions.doubt import Reservation
from service.sessions.records import DiagnosisState, StoredSession
from service.sessions.store import Sessions
from service.storage import Storage
from service.storage.files import LOST
from service.storage.queries import Store
from service.types.rules import tolerances_of
from service.types.store import UnitTypes, held_at
from service.units.store import Units


@dataclass(frozen=True, eq=False)
class Weighing:
    """Stored facts by which a diagnosis is weighed."""

    verdict: Verdict | None
    """Verdict in force; None for a reference, or where nothing was judged."""
    basis: Basis | None
    """Basis of the verdict; None where there is nothing to judge by."""
    tolerances: dict[tuple[str, str], float]
    known: frozenset[tuple[str, str]]
    """Causes in the model in force, with the sensor or an empty name."""
    temperatures: Covered | None
    """Temperatures of the session, besides those of its unit; None where nothing states them."""
    steps: Steps = field(default_factory=dict)
    """Effects of its temperature, taken off before it was judged."""


@dataclass(frozen=True)
class Weighed:
    """Effect of a diagnosis on the verdict."""

    verdict_after: Verdict | None
    """Verdict with the named causes in the model; None where none was named, or where nothing was judged."""
    reservations: tuple[Reservation, ...]


def weighing_of(store: Store, id: str, block: str) -> Weighing:
    """The basis of a session's judgement, and for a reference the tolerances that held when it was computed."""
    stored, decisions = Sessions(store).get(id), Sessions(store).decisions(id)
    computed = Derivations(store).computed_at([id])[id]
    unit_type = held_at(UnitTypes(store).of_unit_through_time(stored.unit), computed)
    unit = Units(store).key(stored.unit)
    found = reference_of(store, unit, block, stored.programme, stored.started_at)
    is_judged = bool(decisions) and found.session is not None and not stored.is_reference
    basis, temperatures = None, None
    if is_judged and found.session is not None:
        reference, k = Calibrations(store).get(found.session), nominal_factor_of(decisions)
        basis = Basis(reference, unit_type, k, steps_in(decisions))
        temperatures = _temperatures(store, stored, basis, found.since)
    accepted = in_force([r for r in Models(store).of_session(id) if r.id <= stored.revision])
    own = Calibrations(store).get(id) if accepted or (basis is None and not unit_type.are_entered) else None
    sensors = () if own is None else own.sensors
    return Weighing(
        verdict=stored.verdict if is_judged else None,
        basis=basis,
        tolerances=tolerances_of(unit_type, own if basis is None else basis.reference),
        known=frozenset((r.cause, place) for r in accepted for place in places_of(r, sensors)),
        temperatures=temperatures,
        steps=steps_in(decisions),
    )


def _temperatures(store: Store, session: StoredSession, basis: Basis, since: datetime | None) -> Covered | None:
    """A session's temperature beside those of its unit; with its history where it lies outside them."""
    earlier = Sessions(store).before(session, since, MOST_EARLIER)
    seen = covered_by(session, basis.reference.residuals, earlier, basis.steps)
    if seen is None or not seen.is_far:
        return seen
    unit, at = Units(store).key(session.unit), session.started_at
    changes = tuple(row for row in Outlooks(store).changes(unit, since) if row.at < at)
    references = tuple(row for row in Outlooks(store).references(unit, since) if row.at < at)
    return replace(seen, changes=changes, references=references)


@outside_writing
def weigh(session: CalibrationSession, found: Diagnosed, weighing: Weighing) -> Weighed:
    """The numerical part, with no store at hand."""
    after = weighing.basis.verdict_of(found.calibration) if weighing.basis is not None and found.findings else None
    others: tuple[Otherwise, ...] = ()
    if weighing.basis is not None:
        others = tuple(verdicts_under_alternatives(session, found.findings, weighing.basis))
    if after is not None:
        first = found.findings[0]
        causes = tuple(finding.cause for finding in found.findings)
        others = (Otherwise(causes, first.sensors, after, named=True), *others)
    doubted = Doubted(
        verdict=weighing.verdict,
        findings=found.findings,
        structures=found.structures,
        noise=found.noise,
        yardstick=Yardstick(found.calibration, found.residuals_before, weighing.tolerances),
        otherwise=others,
        known=weighing.known,
        temperatures=weighing.temperatures,
        worth=worth_at(weighing.temperatures, weighing.steps.keys()),
    )
    return Weighed(after, reservations_of(doubted))


def unlooked(storage: Storage, id: str) -> tuple[Reservation, ...]:
    """The reservations of a session whose programme shows no causes."""
    with storage.database.reading() as store:
        weighing = weighing_of(store, id, Sessions(store).block(id))
    return reservations_at(weighing.temperatures)


@dataclass(frozen=True)
class Weighable:
    """Inputs of a weighing that can change."""

    basis: str | None
    document: str | None
    """The diagnosis; None where there is none, or where it found nothing to weigh."""


@dataclass(frozen=True)
class WeighedAgain:
    """The reservations of a verdict."""

    id: str
    weighable: Weighable
    reservations: tuple[Reservation, ...] | None
    """New reservations; None where there is nothing to weigh."""


def weighable(store: Store, session: Counted) -> Weighable:
    """The inputs of a session's weighing as they are now."""
    made = Diagnoses(store).get(session.id)
    return Weighable(session.rests_on, None if made is None or made.found is None else made.document)


def weighed_again(storage: Storage, session: Counted) -> WeighedAgain:
    """The reservations of a session after another calibration or verdict of it came into force; where its file is lost
    or can no longer be read, the reservation that it was not checked. No transaction is open.
    """
    id = session.id
    with storage.database.reading() as store:
        weighed, stored, made = weighable(store, session), Sessions(store).get(id), Diagnoses(store).get(id)
    if made is not None and made.state is DiagnosisState.NOT_APPLICABLE:
        return WeighedAgain(id, weighed, unlooked(storage, id))
    if made is None or made.found is None:
        return WeighedAgain(id, weighed, None)
    try:
        source = read_upload(storage.files.content(stored.sha256), stored.filename)
    except (*LOST, SessionError):
        return WeighedAgain(id, weighed, UNCHECKED)
    with storage.database.reading() as store:
        weighing = weighing_of(store, id, source.block)
    return WeighedAgain(id, weighed, weigh(source, made.found, weighing).reservations)
