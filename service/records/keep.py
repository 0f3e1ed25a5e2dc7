"""Step: what the database keeps of sessions' calibrations under a model revision, beside what others gave."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime

from estimator.results import Calibration
from service.judging.parameter_values import parameter_values
from service.sessions.calibration_document import Packed, pack
from service.sessions.calibrations_store import Calibrations
from service.sessions.history_store import History
from service.sessions.records import ParameterValue, StoredSession
from service.storage.store import Store


@dataclass(frozen=True, eq=False)
class Made:
    """A calibration on its way into the store."""

    calibration: Calibration
    packed: Packed
    values: tuple[ParameterValue, ...]


def made(calibration: Calibration) -> Made:
    """Ready to be kept, with no transaction open."""
    return Made(calibration, pack(calibration), parameter_values(calibration))


def keep(store: Store, unit: int, new: Sequence[tuple[StoredSession, Made]], at: datetime) -> None:
    """The calibrations and the parameters of the history; what is decided of them is derived."""
    Calibrations(store).add([(record, one.packed) for record, one in new], at)
    History(store).add(unit, [(record, one.values) for record, one in new])
