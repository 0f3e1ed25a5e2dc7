"""Doubts about a session's file, their corrections, and the reservations of verdicts."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

from estimator.message import joined, say
from service.kit.answer import answer
from service.sessions.decision import Verdict


class Remedy(StrEnum):
    """Kinds of correction of a file."""

    READINGS = "readings"
    """The readings of some sensors, and their standard errors, times a factor."""
    NOMINAL = "nominal scale"
    """The nominal scale factor of some sensors times a factor."""
    BOTH = "readings and nominal scale"
    """Both times a factor."""
    EXCHANGE = "exchange"
    """The readings of two sensors, one for the other."""
    UNIT = "unit"
    """The serial number of the unit."""


@dataclass(frozen=True)
class FileCorrection:
    """A corrected file that can be made of the first one."""

    remedy: Remedy
    sensors: tuple[str, ...] = ()
    factor: float = 1.0
    unit: str = ""
    """Unit of the session, where that is corrected."""

    @property
    def text(self) -> str:
        """The correction as stated in the corrected file's notes."""
        who = joined(" and ", self.sensors) if len(self.sensors) < 3 else f"{self.sensors[0]}–{self.sensors[-1]}"
        if self.remedy is Remedy.UNIT:
            return say("unit {unit}", unit=self.unit)
        if self.remedy is Remedy.EXCHANGE:
            return say("readings of {sensors} exchanged", sensors=who)
        return say("{value} of {sensors} × {factor}", value=self.remedy.value, sensors=who, factor=f"{self.factor:.6g}")


@dataclass(frozen=True)
class Doubt:
    """One doubt about a file: a value that cannot be as stated."""

    problem: str
    """Beyond what physics allows, with the numbers."""
    slip: str
    """Probable cause."""
    correction: FileCorrection | None = None
    """Correction of the file; None where no factor and no exchange puts it right."""
    stands_for: str | None = None
    """The session that this one counts twice with, and could stand for."""

    @property
    def text(self) -> str:
        """The doubt in a sentence or two."""
        remedy = (
            ""
            if self.correction is None
            else say(" A file with the {text} would correct it.", text=self.correction.text)
        )
        if self.stands_for is not None:
            remedy = " Together they would count twice: choose the one that counts."
        return say("{what}: {slip}.{remedy}", what=self.problem, slip=self.slip, remedy=remedy)


@dataclass(frozen=True)
class Remedies:
    """Ways to put a questioned session right."""

    correction: str = ""
    """Contents that a corrected file would change; empty where none is known."""
    stands_for: str | None = None
    """The session that it could stand for."""
    unit: str = ""
    """Unit that was probably measured; empty where that is not in doubt."""


def remedies_among(doubts: Iterable[Doubt]) -> Remedies:
    """All corrections in one file, and the first session that it could stand for."""
    found = tuple(doubts)
    known = tuple(doubt.correction for doubt in found if doubt.correction is not None)
    stands_for = next((doubt.stands_for for doubt in found if doubt.stands_for is not None), None)
    return Remedies(joined(", ", (d.text for d in known)), stands_for, next((d.unit for d in known if d.unit), ""))


class DoubtKind(StrEnum):
    """Reason for a reservation, in the order in which reservations are listed."""

    RECORD = "record"
    """The file states something else than was done."""
    NOT_CHECKED = "not-checked"
    """No causes could be looked for."""
    PENDING = "pending"
    """Causes are still being looked for: in the list for programs; people read it in the verdict."""
    TEMPERATURE = "temperature"
    """The session was measured far from the temperatures of the unit's reference and earlier sessions."""
    CAUSE = "cause"
    """A named cause is large beside the tolerance."""
    OTHER_MODEL = "other-model"
    """The verdict is another under a model that the readings leave standing."""
    UNEXPLAINED = "unexplained"
    """Structure that no known cause explains is large beside the tolerance."""
    STATED_ERRORS = "stated-errors"
    """The readings contradict the standard errors that the file states."""
    HAND_TURNS = "hand-turns"
    """Turns by hand gave its gyros no scale factors, or with a larger uncertainty."""


@answer
@dataclass(frozen=True)
class Reservation:
    """One reason against taking a verdict as it stands."""

    kind: DoubtKind
    """`record`: the file is wrong. `not-checked`: no causes could be looked for. `pending`: they are still being looked
    for; ask again. `temperature`: it was measured far from the temperatures of the unit's reference and earlier
    sessions, which can make or hide a change. `cause`: a named cause takes more than a third of a tolerance.
    `other-model`: the verdict is another under a model that the readings leave standing. `unexplained`: so does
    structure that no known cause explains. `stated-errors`: the readings contradict the standard errors of the file.
    `hand-turns`: turns by hand gave its gyros no scale factors and axes, or with a larger uncertainty."""
    text: str
    """Reason for the reservation, as a clause that stands after `but`."""
    advice: str
    """Advice, as a clause."""
    sensors: tuple[str, ...] = ()
    """Sensors that it concerns; empty where it concerns all, or none in particular."""
    cause: str | None = None
    """The named cause."""
    parameter: str | None = None
    """Parameter against whose tolerance the size is held."""
    size: float | None = None
    """Size in the tolerance's unit, SI; relative for a scale factor."""
    uncertainty: float | None = None
    """Standard uncertainty of the size."""
    share: float | None = None
    """Size by tolerance."""
    verdict: Verdict | None = None
    """Verdict of the session under the other model."""


Reservations = tuple[Reservation, ...] | None
"""Reservations of a verdict; None while causes are still being looked for."""
