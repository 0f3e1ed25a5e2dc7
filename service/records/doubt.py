"""What of a session cannot be as its file says, which slip is likely, and what would put it right."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum


class Remedy(StrEnum):
    """What a corrected file does to the first one."""

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
class Correction:
    """A corrected file that can be made of the first one."""

    remedy: Remedy
    sensors: tuple[str, ...] = ()
    factor: float = 1.0
    unit: str = ""
    """Which it is of, where that is what is corrected."""

    @property
    def text(self) -> str:
        """What it does, as the corrected file's notes say it."""
        who = " and ".join(self.sensors) if len(self.sensors) < 3 else f"{self.sensors[0]}–{self.sensors[-1]}"
        if self.remedy is Remedy.UNIT:
            return f"unit {self.unit}"
        if self.remedy is Remedy.EXCHANGE:
            return f"readings of {who} exchanged"
        return f"{self.remedy.value} of {who} × {self.factor:.6g}"


@dataclass(frozen=True)
class Doubt:
    """One thing that cannot be as the file says."""

    what: str
    """Beyond what physics allows, with the numbers."""
    slip: str
    """What has probably happened."""
    correction: Correction | None = None
    """None where no factor and no exchange puts it right."""
    stands_for: str | None = None
    """The session that this one counts twice with, and could stand for."""

    @property
    def text(self) -> str:
        """In a sentence or two."""
        remedy = "" if self.correction is None else f" A file with the {self.correction.text} would put it right."
        if self.stands_for is not None:
            remedy = " Together they would count twice: say which one counts."
        return f"{self.what}: {self.slip}.{remedy}"


@dataclass(frozen=True)
class Remedies:
    """What would put a questioned session right."""

    correction: str = ""
    """What a corrected file would hold otherwise; empty where nothing is known."""
    stands_for: str | None = None
    """The session that it could stand for."""
    unit: str = ""
    """Which it probably is of; empty where that is not in doubt."""


def remedies_among(doubts: Iterable[Doubt]) -> Remedies:
    """All corrections in one file, and the first session that it could stand for."""
    found = tuple(doubts)
    known = tuple(doubt.correction for doubt in found if doubt.correction is not None)
    stands_for = next((doubt.stands_for for doubt in found if doubt.stands_for is not None), None)
    return Remedies(", ".join(one.text for one in known), stands_for, next((one.unit for one in known if one.unit), ""))
