"""Verdicts, and the decision on one parameter of one sensor with its whole basis."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from math import inf

from estimator.coverage import nominal_factor
from estimator.health import ParameterJudgement
from estimator.health.common_motion import CommonMotion
from estimator.health.temperature_law import Steps
from estimator.message import capitalised, say
from estimator.results import COVERAGE, Calibration


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


class Opening(StrEnum):
    """Way in which a session became a reference."""

    FIRST = "first"
    SERVICE = "service"
    """The first session after a service."""
    CHOSEN = "chosen"
    """Chosen by an engineer."""


@dataclass(frozen=True, kw_only=True)
class Decision(ParameterJudgement):
    """The estimator's judgement of one parameter, with the rule it rests on: all that the store and the API keep."""

    verdict: Verdict
    coverage_factor: float
    """k, Student's t where the noise is known to few degrees of freedom."""
    rule: str
    """Name, version and the revision of the tolerances, ``ILAC-G8-four-state/3 (hex-cone rev 2)``."""

    @property
    def nominal_factor(self) -> float:
        """The k for known noise that the coverage factor was made of."""
        return nominal_factor(self.coverage_factor, self.dof)

    @property
    def guard_band(self) -> float | None:
        """w = U."""
        return self.expanded

    @property
    def margin(self) -> float | None:
        """1 − (|d| + U)/T: 1 is no change, 0 the limit of a pass, negative beyond; None when not observed."""
        if self.deviation is None or self.expanded is None:
            return None
        return 1 - (abs(self.deviation) + self.expanded) / self.tolerance


def nominal_factor_of(decisions: tuple[Decision, ...]) -> float:
    """The k for known noise that a session was judged with; the common one of a session that was not judged."""
    return decisions[0].nominal_factor if decisions else COVERAGE


def steps_in(decisions: tuple[Decision, ...]) -> Steps:
    """The corrections for temperature, by sensor and parameter."""
    rows = ((decision.sensor, decision.parameter, decision.temperature_correction) for decision in decisions)
    return {(sensor, parameter): taken for sensor, parameter, taken in rows if taken is not None}


def worst_of(decisions: tuple[Decision, ...]) -> Decision | None:
    """The decision that sets a session's verdict: the worst verdict, and of those the least margin."""
    return max(decisions, key=badness, default=None)


def badness(decision: Decision) -> tuple[int, float]:
    """Orders decisions: the larger, the worse."""
    margin = decision.margin
    return decision.verdict.severity, -inf if margin is None else -margin


@dataclass(frozen=True)
class ServiceFault:
    """A sensor that fails within a recording in service, in words."""

    sensors: tuple[str, ...]
    """Sensors out of tolerance: the faulty one, both that are exchanged, or each that could be it."""
    place: str
    """The sensor; empty where it is not one alone."""
    what: str
    """Kind, start and size of the fault, as a clause."""
    remedy: str
    """Remedy, as a clause."""

    @property
    def sentence(self) -> str:
        """Both."""
        return say("{what}: {remedy}.", what=capitalised(self.what), remedy=self.remedy)


@dataclass(frozen=True)
class Judged:
    """A session on its way into the store."""

    calibration: Calibration
    decisions: tuple[Decision, ...]
    reason: str
    is_reference: bool
    """Whether later sessions are judged against it."""
    motions: tuple[CommonMotion, ...] = ()
    """Motions common to all sensors since the reference."""
    faults: tuple[ServiceFault, ...] = ()
    """Sensors that fail within a recording in service."""

    @property
    def verdict(self) -> Verdict:
        """Verdict of the worst decision; with a faulty sensor the unit fails, whatever has a tolerance."""
        if self.faults:
            return Verdict.FAIL
        return Verdict.UNDECIDABLE if self._worst is None else self._worst.verdict

    @property
    def worst(self) -> Decision | None:
        """Decision that sets the verdict; None when nothing was judged, as for a reference."""
        return None if self.is_reference else self._worst

    @cached_property
    def _worst(self) -> Decision | None:
        return worst_of(self.decisions)
