"""Records of stands: their use, their own health and their certificates; SI."""

from dataclasses import dataclass
from datetime import date, datetime
from math import isfinite

from estimator.health.common_motion import AXES, SCALES
from service.kit.answer import answer

STILL: dict[str, tuple[tuple[float, ...], tuple[tuple[float, ...], ...]]] = {
    AXES: ((0.0,) * 3, ((0.0,) * 3,) * 3),
    SCALES: ((0.0,), ((0.0,),)),
}
"""Value and covariance of a reference's motion, zero by definition: of all axes (rad) and of all scales (relative)."""


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and isfinite(value)


@dataclass(frozen=True)
class MotionOnStand:
    """Common motion of all sensors of one block at one session on a stand."""

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
    """Use of a stand."""

    stand: str
    sessions: int
    """Number of accepted sessions."""
    units: int
    """Units measured in them."""
    last_at: datetime | None
    """Start of the latest of them; None where none is accepted."""


@answer
@dataclass(frozen=True)
class StandEvidence:
    """Evidence of the units on one quantity of one stand."""

    kind: str
    """`accelerometer` or `gyroscope`."""
    quantity: str
    """`axes` or `scales`."""
    since: datetime
    """First session that shows the shift, UTC."""
    until: datetime | None
    """First session that shows it no more, UTC; null while it lasts."""
    value: tuple[float, ...]
    """Turn in block axes, rad, or relative change of all scales."""
    size: float
    """Angle of the turn, or the relative change."""
    sigma: float
    """Standard uncertainty of the size."""
    chi2: float
    """Improvement of the units' fit by the shift, as chi-square."""
    p_value: float
    """Chance of as much when nothing shifted, all dates and stands considered."""
    units: int
    """Number of units with evidence on it."""
    agreeing: int
    """Units among them that show the shift."""
    has_shifted: bool
    """Whether it counts as a shift of the stand."""


@answer
@dataclass(frozen=True)
class StandSeating:
    """Scatter of the seating of blocks on a stand, from one mounting to the next."""

    kind: str
    """`accelerometer` or `gyroscope`."""
    quantity: str
    """`axes` or `scales`."""
    tau: float
    """Standard deviation per component: of a turn rad, of all scales relative."""


@answer
@dataclass(frozen=True)
class StandCondition:
    """A stand as the units measured on it show it."""

    stand: str
    """Name of the stand."""
    sessions: int
    """Sessions that it is judged by."""
    has_shifted: bool
    """Whether it now shifts every unit that is measured on it."""
    reason: str
    """Reason in one sentence."""
    evidence: tuple[StandEvidence, ...]
    """Most evident, for every quantity on which there is evidence."""
    shifts: tuple[StandEvidence, ...]
    """Every shift, also one that was taken back; oldest first."""
    seating: tuple[StandSeating, ...]
    """Scatter of mountings, of every quantity."""
    unreadable: tuple[str, ...]
    """Sessions left out: their stored results cannot be used."""


@dataclass(frozen=True)
class KnownStand:
    """Use and condition of a stand."""

    use: StandUse
    condition: StandCondition | None
    """Latest condition; None where no session shows it."""


@answer
@dataclass(frozen=True)
class StandCertificate:
    """The certificate of a stand's own calibration."""

    stand: str
    """Name of the stand."""
    number: str
    """Number as printed on it."""
    issued_by: str
    """The laboratory that calibrated the stand."""
    issued_on: date
    """Day from which it holds for the stand."""
    valid_until: date
    """Last day on which it holds."""


@answer
@dataclass(frozen=True)
class StandError:
    """Uncertainty of one error of a stand by its certificate."""

    name: str
    """Name as in the session file's `stand.sigma_arcsec`."""
    sigma: float
    """Standard uncertainty, rad."""
