"""Turns the result of the search into findings that people read."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from estimator.causes.catalogue import UNEXPLAINED
from estimator.causes.contract import Cause
from estimator.causes.sensor import ExcessNoise
from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.explanation.naming import merged, named_cause
from estimator.diagnosis.explanation.power_on import timed_from_power_on
from estimator.diagnosis.explanation.rivals import CREDIBLE, alternatives, ranking, separations
from estimator.diagnosis.explanation.sensor_or_stand import parity_split
from estimator.diagnosis.explanation.shared_course import CourseMember, shared_finding
from estimator.diagnosis.posterior.explained import (
    AppliedCourse,
    Autocorrelation,
    Detection,
    ExcessVariance,
    ExplainedSession,
    NoiseClaim,
)
from estimator.diagnosis.residuals.remaining import remaining_of_sensors
from estimator.diagnosis.results import Course, Finding, NoiseScale, Structure
from estimator.message import joined, say
from estimator.session import ACCELEROMETER, Array

BEYOND_NOISE = 30.0
"""Times the stated standard errors from which on scatter is no misjudged noise: stated ones were seen to be four to
twenty times too small."""


def findings(state: ExplainedSession, fitted: Amplitudes, new: Sequence[bool | None]) -> tuple[Finding, ...]:
    """Named causes, strongest first; the same cause on several sensors is one finding that lists them all.

    ``new``: of every finding, whether it came since the history.
    """
    named = [
        CourseMember(f, finding(state, f, fitted, part, since), part)
        for f, part, since in zip(state.detections, fitted.slices, new, strict=True)
    ]
    cause = noise_cause(state)
    excess = [] if cause is None else [excess_finding(state, cause, e) for e in state.excess]
    shared = [shared_finding(state, members, fitted) for members in courses(named)]
    of_sensors = merged([(m.detection.best.cause, m.finding) for m in named if not any(m in c for c in courses(named))])
    whole = (timed_from_power_on(f, state.baseline.session) for f in (*shared, *of_sensors, *excess))
    return tuple(sorted(whole, key=lambda f: -f.strength))


def courses(named: Sequence[CourseMember]) -> list[list[CourseMember]]:
    """Findings of sensors that share a course, course by course."""
    together: dict[tuple[str, tuple[int, ...]], list[CourseMember]] = {}
    for m in named:
        if m.detection.event:
            together.setdefault((m.detection.best.cause.identifier, m.detection.event), []).append(m)
    return [members for members in together.values() if len(members) > 1]


def finding(
    state: ExplainedSession, detection: Detection, fitted: Amplitudes, part: slice, new: bool | None
) -> Finding:
    """One named cause; ``part``: its amplitudes among all."""
    best, cause = detection.best, detection.best.cause
    place = slice(part.start, part.start + len(cause.units))
    amplitude, sigma = cause.reported(
        state.baseline.setting, best.shape, fitted.value[place], np.sqrt(np.diagonal(fitted.covariance)[place])
    )
    others = alternatives(state, detection)
    gyro = cause.kind is None and any(state.baseline.setting.kinds[i] != ACCELEROMETER for i in best.sensors)
    return replace(
        named_cause(cause, tuple(state.names[i] for i in best.sensors), detection.p_family, best.strength),
        amplitude=tuple(map(float, amplitude)),
        sigma=tuple(map(float, sigma)),
        units=tuple(u.replace("m/s²", "rad/s") if gyro else u for u in cause.units),
        nonlinear_each=(nonlinear(cause.nonlinear_units, best.shape.nonlinear),),
        alternatives=(
            *(r.cause.identifier for r in others),
            *((UNEXPLAINED,) if detection.unnamed > 1 - CREDIBLE else ()),
        ),
        separations=separations(state, detection, others),
        ranking=ranking(state, detection),
        parity=parity_split(state, detection),
        new=new,
    )


def nonlinear(units: Sequence[str], values: Sequence[float]) -> dict[str, float]:
    """The shape parameters by unit, ``s 1`` and ``s 2`` where two share one; rows counted from 1."""
    names = [f"{u} {units[: k + 1].count(u)}" if units.count(u) > 1 else u for k, u in enumerate(units)]
    pairs = zip(names, units, values, strict=False)
    return {name: value + 1 if unit == "row" else value for name, unit, value in pairs}


def noise_cause(state: ExplainedSession) -> Cause | None:
    """The cause of the catalogue that names noise above the stated one; None where it holds none."""
    return next((c for c in state.catalogue if isinstance(c, ExcessNoise)), None)


def excess_finding(state: ExplainedSession, cause: Cause, excess: ExcessVariance) -> Finding:
    """A sensor noisier than stated: the amplitude is the extra standard deviation of a reading at the input."""
    sensor = state.baseline.session.sensors[excess.sensor]
    stated, taken = (float(np.mean(v[:, excess.sensor])) for v in (state.stated, state.baseline.variance))
    energy, freedom = (float(x[excess.sensor]) for x in remaining_of_sensors(state.residuals, named_columns(state)))
    whole = max(taken * energy / max(freedom, 1.0), stated * (1 + 1 / excess.freedom))
    extra = float(np.sqrt(whole - stated))
    sigma = whole * float(np.sqrt(2 / excess.freedom)) / (2 * extra)
    return replace(
        named_cause(cause, (sensor.name,), excess.p_family, excess.strength),
        amplitude=(extra,),
        sigma=(sigma,),
        units=("m/s²" if sensor.kind == ACCELEROMETER else "rad/s",),
        alternatives=(UNEXPLAINED,) if excess.doubtful else (),
    )


def named_columns(state: ExplainedSession) -> Array | None:
    """(R, m, q) m/s² (rad/s): everything that is named; None where nothing is."""
    each = [f.best.shape.columns for f in state.detections]
    return np.concatenate(each, axis=-1) if each else None


def place(course: Autocorrelation) -> str:
    """The order along which a sensor's course runs, or its wave, in words."""
    if course.order.startswith("harmonic"):
        return say("{wave}, in no known pattern", wave=course.order)
    return say("smooth along {order}, in no known pattern", order=course.order)


def structures(state: ExplainedSession) -> tuple[Structure, ...]:
    """Unexplained structure, with its place."""
    changed = [
        Structure(f.best.cause.sentence, tuple(state.names[i] for i in f.best.sensors), f.p_family, f.best.strength)
        for f in state.structures
    ]
    courses = [
        Structure(
            place(course),
            (state.names[course.sensor],),
            course.p_value,
            course.strength,
        )
        for course in state.autocorrelated
    ]
    unnamed = state.excess if noise_cause(state) is None else ()
    larger = [Structure("larger than stated", (state.names[e.sensor],), e.p_family, e.strength) for e in unnamed]
    return (*changed, *map(common_course, state.courses), *courses, *larger, *beyond_noise(state))


def common_course(course: AppliedCourse) -> Structure:
    """A course of the applied vector that no cause describes."""
    quantity = joined(" and ", course.components) or "the vector"
    return Structure(
        say(
            "an error of stand, fixture or reference that no known cause explains ({quantity}, along {order})",
            quantity=quantity,
            order=course.order,
        ),
        (),
        course.p_value,
        course.strength,
        Course(course.order, course.components, tuple(map(tuple, course.value.tolist()))),
    )


def noise_scales(state: ExplainedSession) -> tuple[NoiseScale, ...]:
    """Sensors whose stated standard errors the readings contradict."""
    return tuple(_noise_scale(state, claim) for claim in state.noise_claims)


def _noise_scale(state: ExplainedSession, claim: NoiseClaim) -> NoiseScale:
    whole = state.baseline.setting.kinds.count(claim.kind) == len(claim.sensors)
    sensors = () if whole else tuple(state.names[i] for i in claim.sensors)
    return NoiseScale(claim.kind, float(np.sqrt(claim.ratio)), claim.freedom, sensors)


def beyond_noise(state: ExplainedSession) -> Iterator[Structure]:
    """The structures of kinds of sensor that scatter as no noise does."""
    for scale in noise_scales(state):
        if scale.factor > BEYOND_NOISE:
            where = say(
                "scatter {factor} times the stated standard errors: too large for noise",
                factor=f"{scale.factor:.0f}",
            )
            yield Structure(where, scale.sensors, 0.0, float(np.sqrt(scale.freedom)) * scale.factor)


def notes(state: ExplainedSession) -> tuple[str, ...]:
    """Remarks for readers of the findings."""
    if not state.in_tails:
        return ()
    far = max(f.best.strength for f in state.in_tails)
    return (
        say(
            "Single readings deviate by up to {far} standard errors. All readings have errors with such tails, so no "
            "cause is named for them.",
            far=f"{far:.1f}",
        ),
    )
