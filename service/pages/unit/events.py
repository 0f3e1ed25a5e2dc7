"""Events of a unit in one list; and the unit as found and as left."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.message import say
from service.kit.measures import deviation_measure, limit, measured, signed
from service.papers.found_and_left import FoundAndLeft
from service.sessions.decision import Decision, badness
from service.sessions.records import StoredSession
from service.sessions.states import StateChange
from service.sessions.words.conditions import NOT_JUDGED, Condition, condition_of, state_in_words
from service.units.records import CustodyStep, NewService, Note, Service

KINDS = {
    "adjustment": "Adjustment",
    "repair": "Repair",
    "sensor-swap": "Sensor swap",
    "reference": "New reference",
    "service": "Service",
}

STEPS = {
    CustodyStep.ENTERED: "Entered",
    CustodyStep.MOVED: "Moved",
    CustodyStep.RETIRED: "Retired",
    CustodyStep.RETURNED: "Put back into use",
}


@dataclass(frozen=True)
class UnitEvent:
    """A service or a note."""

    at: datetime
    heading: str
    text: str
    who: str
    note: Note | None
    """Note; None for a service, which is a break in the history."""
    service: Service | None = None
    withdrawn: str = ""
    """Time, person and reason of a service's withdrawal; empty where it is not withdrawn."""


@dataclass(frozen=True)
class StageCell:
    """One parameter's deviation at one of the two sessions."""

    text: str
    condition: Condition


@dataclass(frozen=True)
class StageRow:
    """One parameter of one sensor."""

    sensor: str
    parameter: str
    tolerance: str
    found: StageCell
    left: StageCell | None


@dataclass(frozen=True)
class StageTable:
    """The unit as found and as left."""

    found: StoredSession
    left: StoredSession | None
    rows: tuple[StageRow, ...]
    """Rows by parameter; empty where the unit was found at its reference."""


def events_of(
    services: Sequence[Service], notes: Sequence[Note], withdrawals: Sequence[StateChange] = ()
) -> tuple[UnitEvent, ...]:
    """The events of a unit, newest first."""
    gone = {line.record: state_in_words(line) for line in withdrawals}
    listed = [UnitEvent(s.at, service_in_words(s), s.note, s.who, None, s, gone.get(str(s.id), "")) for s in services]
    listed += [UnitEvent(note.at, "Note", note.text, note.who, note) for note in notes]
    return tuple(sorted(listed, key=lambda event: event.at, reverse=True))


def service_in_words(service: Service | NewService) -> str:
    """``Repair of A3``."""
    sensor = say(" of {sensor}", sensor=service.sensor) if service.sensor else ""
    return say("{kind}{sensor}", kind=KINDS.get(service.kind, service.kind), sensor=sensor)


def stage_table(pair: FoundAndLeft | None) -> StageTable | None:
    """Both sessions beside each other, the worst parameter as found first; None where it was never marked as found."""
    if pair is None:
        return None
    rows = tuple(_row(*both) for both in sorted(pair.decisions, key=lambda both: badness(both[0]), reverse=True))
    return StageTable(pair.found, pair.left, rows)


def _row(found: Decision, left: Decision | None) -> StageRow:
    largest = max(abs(d.deviation or 0.0) for d in (found, left) if d is not None)
    measure = deviation_measure(found.kind, found.parameter, max(largest, found.tolerance))
    is_angle = found.parameter == "axis"

    def cell(decision: Decision) -> StageCell:
        if decision.deviation is None:
            return StageCell("not observable", NOT_JUDGED)
        write = measured if is_angle else signed
        return StageCell(write(decision.deviation, decision.expanded, measure), condition_of(decision.verdict))

    return StageRow(
        found.sensor,
        found.parameter,
        limit(found.tolerance, measure, is_angle),
        cell(found),
        None if left is None else cell(left),
    )
