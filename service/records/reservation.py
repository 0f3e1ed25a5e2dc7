"""What speaks against taking a verdict as it stands, said in the same breath as the verdict."""

from dataclasses import dataclass
from enum import StrEnum

from service.records.answer import answer
from service.records.decision import Verdict


class Doubt(StrEnum):
    """Why a verdict carries a reservation, in the order in which reservations are told."""

    RECORD = "record"
    """The file says something else than what was done."""
    NOT_CHECKED = "not-checked"
    """No causes could be looked for."""
    PENDING = "pending"
    """Causes are still being looked for: told to programs, which read a list; people are told in the verdict."""
    TEMPERATURE = "temperature"
    """It was measured far from the temperatures of the unit's reference and earlier sessions."""
    CAUSE = "cause"
    """A named cause is large beside the tolerance."""
    OTHER_MODEL = "other-model"
    """The verdict is another under a model that the readings leave standing."""
    UNEXPLAINED = "unexplained"
    """Structure that no known cause explains is large beside the tolerance."""
    STATED_ERRORS = "stated-errors"
    """The readings contradict the standard errors that the file states."""


@answer
@dataclass(frozen=True)
class Reservation:
    """One thing that speaks against taking a verdict as it stands."""

    kind: Doubt
    """`record`: the file is wrong. `not-checked`: no causes could be looked for. `pending`: they are still being looked
    for; ask again. `temperature`: it was measured far from the temperatures of the unit's reference and earlier
    sessions, which can make or hide a change. `cause`: a named cause takes more than a third of a tolerance.
    `other-model`: the verdict is another under a model that the readings leave standing. `unexplained`: so does
    structure that no known cause explains. `stated-errors`: the readings contradict the standard errors of the file."""
    text: str
    """What is the matter, as a clause that stands after `but`."""
    advice: str
    """What to do about it, as a clause."""
    sensors: tuple[str, ...] = ()
    """That it concerns; empty where it concerns all, or none in particular."""
    cause: str | None = None
    """The named cause."""
    parameter: str | None = None
    """Whose tolerance the size is held against."""
    size: float | None = None
    """In the tolerance's unit, SI; relative for a scale factor."""
    uncertainty: float | None = None
    """Standard uncertainty of the size."""
    share: float | None = None
    """Size by tolerance."""
    verdict: Verdict | None = None
    """That the session would have under the other model."""


Reservations = tuple[Reservation, ...] | None
"""Of a verdict; None while causes are still being looked for."""
