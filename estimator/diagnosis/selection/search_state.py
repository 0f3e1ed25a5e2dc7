"""State of the search for causes: the residuals, every signature that could explain them, and the findings.

The family-wise level is held over the whole catalogue: Bonferroni over causes, and over the places and shapes of each.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.causes.contract import Cause
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.signatures.applied_course import AppliedCourse
from estimator.diagnosis.signatures.noise import Autocorrelation, ExcessVariance, NoiseClaim, UnlikeNoise
from estimator.diagnosis.signatures.traces import Group, Scored, Traces
from estimator.least_squares import orthonormal
from estimator.session import Array

NAMED = 0.015
"""Family-wise level of the only name of a session. Bonferroni's bound is not reached, since causes resemble one
another: of 2000 sound sessions without a history at most 0.8 % pass (`benchmarks.study.detection`, seeds 101, 202 and
303), and 0.5 % where half of them have one."""

LEVEL = 0.003
"""Family-wise level of every further name, and of all else that is looked for in a session: patterns, scatter, courses
that sensors share."""

NEW_DIRECTION = 1e-6
"""Share of a trace that must lie outside the others' span to count as a direction of its own: rounding lies below."""


@dataclass(frozen=True, eq=False)
class Detection:
    """One selected signature with its rivals."""

    best: Scored
    p_family: float
    """Family-wise p-value."""
    ranking: tuple[tuple[Scored, float], ...]
    """Every (cause, sensors) with its ln evidence, strongest first, given the other findings."""
    unnamed: float = 0.0
    """Probability that no cause of the catalogue acts here, but something that only a free course describes."""
    event: tuple[int, ...] = ()
    """Sensors that share one course with this finding, its own among them: all of them are one misfortune."""
    follows: bool = False
    """Whether it is of a sensor that follows a shared course below what can be named alone."""
    shape_in_doubt: bool = False
    """Whether every sensor of its shared course may as well have a shape of its own."""

    @property
    def cause_log_evidence(self) -> float:
        """ln evidence of the cause that leads the ranking, all its shapes together."""
        return self.ranking[0][1]

    def ranking_on(self, sensors: tuple[int, ...]) -> tuple[tuple[Scored, float], ...]:
        """The ranking as other sensors see it: their own causes and those of no sensor."""
        return tuple(pair for pair in self.ranking if pair[0].sensors in ((), sensors))


@dataclass(frozen=True, eq=False)
class SearchState:
    """State of the search, and in the end its result. n rows, f directions."""

    history: tuple[Baseline, ...]
    catalogue: tuple[Cause, ...]
    residuals: WhitenedResiduals
    traces: tuple[Traces, ...]
    """Traces of the catalogue's causes."""
    patterns: tuple[Traces, ...]
    """Traces of structure without a name."""
    stated: Array
    """(R, m) variance of the noise as the file states it, or as the baseline leaves it, (m/s²)² ((rad/s)²)."""
    detections: tuple[Detection, ...] = ()
    structures: tuple[Detection, ...] = ()
    """Patterns found."""
    excess: tuple[ExcessVariance, ...] = ()
    autocorrelated: tuple[Autocorrelation, ...] = ()
    """Sensors whose residual is not white, though no pattern fits it; where that is plain, no cause is named there."""
    courses: tuple[AppliedCourse, ...] = ()
    """Courses of the applied vector, common to all sensors, that no cause describes."""
    unlike_noise: tuple[UnlikeNoise, ...] = ()
    """Sensors whose scatter is not distributed as noise is."""
    noise_claims: tuple[NoiseClaim, ...] = ()
    """Sensors whose stated noise is taken as known up to a factor only."""
    in_tails: tuple[Detection, ...] = ()
    """Names taken back, because readings far out in the tails of the errors explain as much."""
    refuted: frozenset[Group] = frozenset()
    """Causes on sensors that would have to act more often than they can."""
    apart: bool = False
    """Whether it is known that sensors share no course, each wandering by itself."""

    @property
    def baseline(self) -> Baseline:
        """The fitted session."""
        return self.residuals.baseline

    @property
    def sensor_count(self) -> int:
        """m, number of sensors."""
        return len(self.baseline.unstated)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the sensors, in their order."""
        return tuple(s.name for s in self.baseline.session.sensors)

    @property
    def scatter(self) -> tuple[ExcessVariance | Autocorrelation, ...]:
        """Sensors whose residual is larger than stated or not white."""
        return (*self.excess, *self.autocorrelated)

    @property
    def scatter_attributed(self) -> set[int]:
        """Sensors whose scatter is already known to be excess noise or autocorrelated."""
        return {s.sensor for s in self.scatter}

    @property
    def misfortunes(self) -> int:
        """Number of independent effects found: names, those of one event counted once, and structures."""
        events = {(f.best.cause.identifier, f.event) for f in self.detections if f.event}
        return len(events) + sum(not f.event for f in self.detections) + len(self.structures)

    @property
    def level(self) -> float:
        """Family-wise level of what is named: of one name alone, or of every one of several."""
        return self.level_beside(self.detections[1:])

    @property
    def remaining(self) -> Array:
        """(n,) standard errors: the residuals that findings and structures leave."""
        attributed = self.attributed()
        return np.asarray(self.residuals.z - attributed @ (attributed.T @ self.residuals.z))

    @property
    def families(self) -> int:
        """Number of causes that this session puts to the test."""
        return len(self.traces) + 1

    def level_beside(self, others: Sequence[Detection]) -> float:
        """Family-wise level of a name beside others: only one that is alone has the level of a session."""
        return LEVEL if others or self.scatter else NAMED

    def attributed(self, without: Detection | None = None) -> Array:
        """(n, f) orthonormal, dimensionless: the span of the traces of findings and structures, one left out."""
        parts = [f.best.trace for f in (*self.detections, *self.structures) if f is not without]
        if not parts:
            return np.zeros((len(self.residuals.z), 0))
        return orthonormal(np.concatenate(parts, axis=1), NEW_DIRECTION)
