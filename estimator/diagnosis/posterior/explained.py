"""A session with what explains it: causes with their rivals, unknown courses, noise that is not as stated."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.causes.contract import Cause, Setting, Shape, Signature
from estimator.diagnosis.posterior.common_causes import CommonCauses
from estimator.diagnosis.posterior.sensor_causes import SensorCauses
from estimator.diagnosis.posterior.term import Place
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.between_sessions import parameter_change
from estimator.diagnosis.residuals.remaining import NEW_DIRECTION
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.least_squares import orthonormal
from estimator.session import Array


@dataclass(frozen=True, eq=False)
class Scored:
    """One shape of a cause with its score given other findings. n rows, q amplitudes."""

    cause: Signature
    shape: Shape
    lasting: bool
    """Whether it is taken as having acted since before the history."""
    trace: Array
    """(n, q) standard errors per unit amplitude."""
    statistic: float
    """χ² that it explains."""
    p_value: float
    """p-value of this shape alone."""

    @property
    def sensors(self) -> tuple[int, ...]:
        """The sensors it is attributed to; none for a cause of stand, fixture or record."""
        return self.shape.sensors

    @property
    def group(self) -> Place:
        """The cause and its sensors."""
        return self.cause.identifier, self.sensors

    @property
    def strength(self) -> float:
        """Strength in standard errors."""
        return float(np.sqrt(self.statistic))

    def columns_in(self, setting: Setting) -> Array | None:
        """(R, m, q) m/s² (rad/s) per unit amplitude: the same effect in another session; None where it cannot show."""
        return self.cause.columns(setting, self.shape) if self.cause.available(setting) else None


@dataclass(frozen=True, eq=False)
class Detection:
    """A cause that is named, with its rivals."""

    best: Scored
    p_family: float
    """Probability that nothing at all acts there."""
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


@dataclass(frozen=True)
class ExcessVariance:
    """A sensor noisier than stated."""

    sensor: int
    ratio: float
    """Variance over the stated one."""
    freedom: float
    """Degrees of freedom that tell it."""
    log_evidence: float
    """ln Bayes factor against the stated noise."""
    p_family: float
    """Probability that it is not."""
    doubtful: bool = False
    """Whether it may be an unknown course instead."""

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, with the same evidence."""
        return normal_deviate(self.log_evidence)


@dataclass(frozen=True)
class Autocorrelation:
    """A sensor whose residual runs smoothly along an order of its rows."""

    sensor: int
    order: str
    """The order along which it does so most."""
    log_evidence: float
    """ln Bayes factor against white noise."""

    @property
    def p_value(self) -> float:
        """Chance of as much evidence from noise alone: no more than 1/B (Markov)."""
        return chance_of(self.log_evidence)

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, with the same evidence."""
        return normal_deviate(self.log_evidence)


@dataclass(frozen=True, eq=False)
class AppliedCourse:
    """The likeliest course of the applied vector. R rows, c components."""

    log_evidence: float
    """ln Bayes factor against no course."""
    order: str
    """Order of the rows along which it runs."""
    components: tuple[str, ...]
    """Components of the applied vector that change, in words."""
    value: Array
    """(R, c) most likely course: turns in rad, relative size dimensionless."""

    @property
    def p_value(self) -> float:
        """Chance of as much evidence without any course: no more than 1/B (Markov)."""
        return chance_of(self.log_evidence)

    @property
    def strength(self) -> float:
        """Normal deviate, in standard errors, with the same evidence."""
        return normal_deviate(self.log_evidence)


@dataclass(frozen=True)
class NoiseClaim:
    """Stated noise of sensors of a kind that their readings do not bear out."""

    kind: str
    sensors: tuple[int, ...]
    """Numbers of the sensors in the session's order."""
    ratio: float
    """Variance over the stated one."""
    freedom: float
    """Degrees of freedom that tell it."""


def chance_of(log_evidence: float) -> float:
    """Chance of as large a Bayes factor where nothing acts: no more than 1/B (Markov)."""
    return float(np.exp(-max(log_evidence, 0.0)))


def normal_deviate(log_evidence: float) -> float:
    """Standard errors of a normal deviate of some ln evidence."""
    return float(np.sqrt(2 * max(log_evidence, 0.0)))


@dataclass(frozen=True, eq=False)
class ExplainedSession:
    """A session's residuals with what was found in them. n rows, f directions."""

    history: tuple[Baseline, ...]
    catalogue: tuple[Cause, ...]
    residuals: WhitenedResiduals
    stated: Array
    """(R, m) variance of the noise as the file states it, or as the baseline leaves it, (m/s²)² ((rad/s)²)."""
    detections: tuple[Detection, ...] = ()
    structures: tuple[Detection, ...] = ()
    """Changes of parameters since the history that no cause describes."""
    excess: tuple[ExcessVariance, ...] = ()
    autocorrelated: tuple[Autocorrelation, ...] = ()
    """Sensors with a course of their own that no cause describes."""
    courses: tuple[AppliedCourse, ...] = ()
    """Courses of the applied vector, common to all sensors, that no cause describes."""
    noise_claims: tuple[NoiseClaim, ...] = ()
    """Sensors whose stated noise is taken as known up to a factor only."""
    of_causes: tuple[SensorCauses, CommonCauses] | None = None
    """The catalogue's causes of one sensor and of all as they were sought; None where nothing was."""
    in_tails: tuple[Detection, ...] = ()
    """Names taken back, because readings far out in the tails of the errors explain as much."""

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
    def remaining(self) -> Array:
        """(n,) standard errors: the residuals that findings and structures leave."""
        attributed = self.attributed()
        return np.asarray(self.residuals.z - attributed @ (attributed.T @ self.residuals.z))

    def attributed(self, without: Detection | None = None) -> Array:
        """(n, f) orthonormal, dimensionless: the span of the traces of findings and structures, one left out."""
        parts = [f.best.trace for f in (*self.detections, *self.structures) if f is not without]
        if not parts:
            return np.zeros((len(self.residuals.z), 0))
        return orthonormal(np.concatenate(parts, axis=1), NEW_DIRECTION)


def begin(baseline: Baseline, history: Sequence[Baseline], catalogue: Sequence[Cause]) -> ExplainedSession:
    """A fitted session in which nothing was found yet; ``history`` in the frame of the session."""
    baseline = since(baseline, history)
    residuals = WhitenedResiduals.of(baseline, parameter_change(baseline, history))
    return ExplainedSession(tuple(history), tuple(catalogue), residuals, baseline.variance)


def since(baseline: Baseline, history: Sequence[Baseline]) -> Baseline:
    """The baseline, which knows how the block sits turned since the latest of its history, where that can show."""
    alike = [h for h in history if h.setting.kinds == baseline.setting.kinds]
    turn = alike[-1].turn if alike and not baseline.gauge_free.any() else np.zeros(3)
    return replace(baseline, setting=replace(baseline.setting, turn=turn))


def restart_from(state: ExplainedSession, baseline: Baseline) -> ExplainedSession:
    """The session with another baseline and nothing found; what the file states of the noise is kept."""
    return replace(begin(baseline, state.history, state.catalogue), stated=state.stated)
