"""Verdicts, and the decision on one parameter of one sensor with everything that it rests on."""

from dataclasses import dataclass
from enum import StrEnum

from estimator.health.common_motion import CommonMotion
from estimator.results import Calibration
from estimator.session import CalibrationSession


class Verdict(StrEnum):
    """The four states of ILAC-G8:2019 with guard band, and the honest fifth. Ordered from good to bad by `severity`."""

    PASS = "pass"
    CONDITIONAL_PASS = "conditional-pass"
    UNDECIDABLE = "undecidable"
    CONDITIONAL_FAIL = "conditional-fail"
    FAIL = "fail"

    @property
    def severity(self) -> int:
        return list(Verdict).index(self)


@dataclass(frozen=True)
class Decision:
    """One parameter of one sensor of one session, judged. Everything the decision rests on is here."""

    sensor: str
    kind: str
    parameter: str
    value: float | None
    """The measured parameter, SI; for the axis the angle from the reference axis, rad."""
    reference: float | None
    """SI; 0 for the axis; None while there is no reference."""
    deviation: float | None
    """From the reference: relative for scale, else SI; for the axis the angle freed of the upward pull of noise."""
    uncertainty: float | None
    """Standard uncertainty of the deviation (both sessions)."""
    expanded: float | None
    """U = k·u."""
    coverage_factor: float
    tolerance: float
    guard_band: float | None
    probability_out: float | None
    """Probability that the true deviation is out of tolerance."""
    verdict: Verdict
    rule: str
    """Name, version and the revision of the tolerances, ``ILAC-G8-four-state/2 (hex-cone rev 2)``."""
    critical: float | None = None
    """Smallest deviation that counts as a change at all, at the 1 % level over all judged numbers of the session."""
    change: tuple[float, ...] | None = None
    """The deviation with its sign and direction: one number; two along the reference's tangents for the axis, rad."""
    change_own: tuple[float, ...] | None = None
    """Standard uncertainty that this session brings to each number of the change."""
    change_origin: tuple[float, ...] | None = None
    """The same of the reference session."""
    common: float | None = None
    """What all sensors did together, taken off first: angle of the turn for the axis, rad; relative for scale."""
    common_sigma: float | None = None
    common_p: float | None = None
    """Chance of a common change as large when nothing moved together."""


@dataclass(frozen=True)
class Worst:
    """The parameter that a session's verdict hangs on; all None when nothing was judged."""

    sensor: str | None
    parameter: str | None
    margin: float | None
    """1 − (|d| + U)/T."""


@dataclass(frozen=True)
class Judged:
    """A session on its way into the store."""

    source: CalibrationSession
    calibration: Calibration
    decisions: tuple[Decision, ...]
    verdict: Verdict
    reason: str
    worst: Worst
    is_reference: bool
    motions: tuple[CommonMotion, ...] = ()
    """What all sensors did together since the reference."""
