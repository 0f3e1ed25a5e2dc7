"""What people said of a unit or a session."""

from dataclasses import dataclass

from service.records.event import Attachment, Note, Service
from service.records.state import RecordState, StateChange


@dataclass(frozen=True)
class Said:
    """Withdrawn ones too."""

    notes: tuple[Note, ...]
    files: tuple[Attachment, ...]
    services: tuple[Service, ...]
    """Of the unit."""
    changes: tuple[StateChange, ...]
    """What became of these services, in the order in which it did."""

    @property
    def withdrawals(self) -> tuple[StateChange, ...]:
        """The last change of each service that is withdrawn now."""
        withdrawn = {str(s.id) for s in self.services if s.state is RecordState.WITHDRAWN}
        return tuple({change.record: change for change in self.changes if change.record in withdrawn}.values())


NOTHING_SAID = Said((), (), (), ())
