"""The answer to the one question of a ground computer: may this unit be used?"""

from dataclasses import dataclass
from datetime import date, datetime

from pydantic import computed_field

from service.records.answer import answer
from service.records.decision import Verdict


@answer
@dataclass(frozen=True)
class Usable:
    """Whether a unit may be used now, and why."""

    usable: bool
    """In doubt it is false."""
    why: str
    """In one sentence."""
    reasons: tuple[str, ...]
    """Everything that speaks against it; empty where it may be used."""
    reservations: tuple[str, ...]
    """What must be known although it does not forbid the use."""
    until: datetime | None
    """The next calibration is due then, UTC."""
    verdict: Verdict | None
    """Of the session that the answer rests on."""
    session: str | None
    """The latest judged one; null where there is none since the last service."""
    correction: str | None
    """Id of the session whose correction firmware applies; null where no session calibrates every sensor."""
    as_of: datetime
    """When it was asked, UTC."""

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def reservation(self) -> str:
        """The same as one text; empty where there is none."""
        return " ".join(self.reservations)

    @computed_field  # type: ignore[prop-decorator]  # the one way to describe a property
    @property
    def next_calibration(self) -> date | None:
        """The day of it."""
        return None if self.until is None else self.until.date()
