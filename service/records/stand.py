"""What is known of a stand's own health: frozen records, SI."""

from dataclasses import dataclass
from datetime import datetime
from math import isfinite

from estimator.health.common_motion import AXES, SCALES

STILL: dict[str, tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]] = {
    AXES: ((0.0,) * 3, ((0.0,) * 3,) * 3),
    SCALES: ((0.0,), ((0.0,),)),
}
"""Value and covariance of a reference's motion, zero by definition: of all axes (rad) and of all scales (relative)."""


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and isfinite(value)


@dataclass(frozen=True)
class MotionOnStand:
    """What all sensors of one block did together at one session on a stand."""

    stand: str
    unit: str
    epoch: int
    """Counts the references of the unit before the session: motions of one epoch are from one reference."""
    at: datetime
    kind: str
    quantity: str
    """``axes`` or ``scales``."""
    value: tuple[float, ...]
    covariance: tuple[tuple[float, ...], ...]
    session: str

    @property
    def is_whole(self) -> bool:
        """Whether its numbers are there, finite, and as many as its quantity has."""
        count = len(STILL[self.quantity][0]) if self.quantity in STILL else -1
        rows = (self.value, *self.covariance)
        return len(self.covariance) == count and all(len(row) == count and all(map(_is_number, row)) for row in rows)


@dataclass(frozen=True)
class StandUse:
    """How much a stand is used."""

    stand: str
    sessions: int
    """Accepted ones."""
    units: int
    """That they measured."""
    last_at: datetime | None
    """Of the latest of them; None where none is accepted."""


@dataclass(frozen=True)
class StandEvidence:
    """What the units say of one quantity on one stand: a shift, or the most evident one that chance may explain."""

    kind: str
    quantity: str
    since: datetime
    """Of the first session that shows it."""
    until: datetime | None
    """Of the first session that shows it no more; None while it lasts."""
    value: tuple[float, ...]
    """Turn in block axes, rad, or relative change of all scales."""
    size: float
    sigma: float
    chi2: float
    """Of no shift less that of this one."""
    p_value: float
    """Corrected for the dates and stands that were looked at."""
    units: int
    agreeing: int
    has_shifted: bool
    """Whether it counts as a shift of the stand."""


@dataclass(frozen=True)
class StandSeating:
    """How blocks are seated on a stand, from one mounting to the next."""

    kind: str
    quantity: str
    tau: float
    """One sigma per component: of a turn rad, of scales relative."""


@dataclass(frozen=True)
class StandCondition:
    """A stand, as the units measured on it show it."""

    stand: str
    sessions: int
    """That it is judged by."""
    has_shifted: bool
    """Whether it is elsewhere now than it was."""
    reason: str
    evidence: tuple[StandEvidence, ...]
    """The most evident of every quantity that three or more units tell of."""
    shifts: tuple[StandEvidence, ...]
    """Every shift of the stand, those that were taken back too, oldest first."""
    seating: tuple[StandSeating, ...]
    """Of every quantity."""
    unreadable: tuple[str, ...]
    """Sessions that are left out, because what is stored of their common motion cannot be used."""


@dataclass(frozen=True)
class KnownStand:
    """How much a stand is used, and how it is."""

    use: StandUse
    condition: StandCondition | None
    """As it was last made; None where no session tells of it."""
