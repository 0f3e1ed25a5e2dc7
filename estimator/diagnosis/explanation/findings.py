"""From the search to findings that people read."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from estimator.causes import Cause
from estimator.causes.noise import ExcessNoise
from estimator.diagnosis.explanation.extended_model import Amplitudes
from estimator.diagnosis.explanation.rivals import CREDIBLE, alternatives, ranking, separations
from estimator.diagnosis.explanation.sensor_or_stand import parity_split
from estimator.diagnosis.record.clipping import Clip
from estimator.diagnosis.record.errors import Slip, posterior
from estimator.diagnosis.record.nominal import WrongEntry
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.results import Finding, Rival, Structure
from estimator.diagnosis.selection.search_state import PLAIN, Excess, Found, Search
from estimator.diagnosis.signatures.autocorrelation import Serial
from estimator.diagnosis.signatures.patterns import Structure as Pattern
from estimator.forward import measured
from estimator.session import ACCELEROMETER, CalibrationSession


def findings(state: Search, fitted: Amplitudes, new: Sequence[bool | None]) -> tuple[Finding, ...]:
    """Named causes, strongest first; the same cause on several sensors is one finding that lists them all."""
    named = [(f.best.cause, finding(state, f, fitted, k, new[k])) for k, f in enumerate(state.found)]
    excess = [excess_finding(state, e) for e in state.excess]
    return tuple(sorted((*merged(named), *excess), key=lambda f: -f.strength))


def finding(state: Search, found: Found, fitted: Amplitudes, k: int, new: bool | None) -> Finding:
    """One named cause."""
    best, names = found.best, [s.name for s in state.baseline.session.sensors]
    sensors = tuple(names[i] for i in best.shape.sensors)
    part = slice(fitted.slices[k].start, fitted.slices[k].start + len(best.cause.units))
    amplitude, sigma = best.cause.reported(
        state.baseline.setting, best.shape, fitted.value[part], np.sqrt(np.diagonal(fitted.covariance)[part])
    )
    others = alternatives(found)
    gyro = best.cause.kind is None and any(state.baseline.setting.kinds[i] != ACCELEROMETER for i in best.shape.sensors)
    return Finding(
        cause=best.cause.identifier,
        sensors=sensors,
        amplitude=tuple(map(float, amplitude)),
        sigma=tuple(map(float, sigma)),
        units=tuple(u.replace("m/s²", "rad/s") if gyro else u for u in best.cause.units),
        nonlinear=nonlinear(state, found),
        nonlinear_each=(nonlinear(state, found),),
        p_value=found.p_family,
        strength=best.strength,
        alternatives=tuple(r.cause.identifier for r in others),
        separations=separations(state, found, others),
        ranking=ranking(state, found),
        sentence=sentence(best.cause, sensors),
        advice=best.cause.advice,
        parity=parity_split(state, found),
        new=new,
    )


def spoken(sensors: tuple[str, ...]) -> str:
    """``A1``, ``each of A1 and A2``, ``each of A1, A2 and A3``."""
    names = list(dict.fromkeys(sensors))
    return f"each of {', '.join(names[:-1])} and {names[-1]}" if len(names) > 1 else "".join(names)


def nonlinear(state: Search, found: Found) -> dict[str, float]:
    """The shape parameters by unit; rows counted from 1, a saturation limit at the input."""
    cause, values = found.best.cause, found.best.shape.nonlinear
    shown = {}
    for unit, value in zip(cause.nonlinear_units, values, strict=False):
        shown[unit] = value + 1 if unit == "row" else value
    return shown


def merged(named: Sequence[tuple[Cause, Finding]]) -> list[Finding]:
    """Findings of one cause on several sensors put together, one sentence of all of them."""
    causes, kept = {cause.identifier: cause for cause, _ in named}, dict[str, Finding]()
    for _, f in named:
        old = kept.get(f.cause)
        kept[f.cause] = f if old is None else joined(old, f)
    return [replace(f, sentence=sentence(causes[f.cause], f.sensors)) for f in kept.values()]


def sentence(cause: Cause, sensors: tuple[str, ...]) -> str:
    """What is wrong with some sensors, in words."""
    text = cause.sentence.format(sensors=spoken(sensors))
    return text[:1].upper() + text[1:]


def joined(a: Finding, b: Finding) -> Finding:
    """Two findings of one cause as one."""
    sensors = a.sensors + b.sensors
    both = set(a.alternatives) & set(b.alternatives)
    return Finding(
        cause=a.cause,
        sensors=sensors,
        amplitude=a.amplitude + b.amplitude,
        sigma=a.sigma + b.sigma,
        units=a.units + b.units,
        nonlinear=a.nonlinear,
        nonlinear_each=a.nonlinear_each + b.nonlinear_each,
        p_value=max(a.p_value, b.p_value),
        strength=float(np.hypot(a.strength, b.strength)),
        alternatives=tuple(x for x in a.alternatives if x in both),
        separations=a.separations,
        ranking=a.ranking,
        sentence=a.sentence,
        advice=a.advice,
        parity=a.parity,
        new=a.new if a.new == b.new else None,
    )


def excess_finding(state: Search, excess: Excess) -> Finding:
    """A sensor noisier than stated: the amplitude is the extra standard deviation of a reading at the input."""
    sensor = state.baseline.session.sensors[excess.sensor]
    stated = float(np.mean(state.baseline.variance[:, excess.sensor])) / excess.ratio
    extra = float(np.sqrt(stated * (excess.ratio - 1)))
    sigma = stated * excess.ratio * float(np.sqrt(2 / excess.freedom)) / (2 * extra)
    cause = ExcessNoise()
    return Finding(
        cause=cause.identifier,
        sensors=(sensor.name,),
        amplitude=(extra,),
        sigma=(sigma,),
        units=("m/s²" if sensor.kind == ACCELEROMETER else "rad/s",),
        nonlinear={},
        nonlinear_each=({},),
        p_value=excess.p_family,
        strength=float(np.sqrt(2 * max(excess.evidence, 0.0))),
        alternatives=(),
        separations=(),
        ranking=(),
        sentence=sentence(cause, (sensor.name,)),
        advice=cause.advice,
        parity=None,
        new=None,
    )


def slip_finding(slip: Slip, session: CalibrationSession) -> Finding:
    """A slip in the record, with the other ways to put it right that do as well."""
    names = [s.name for s in session.sensors]
    rows = slip.cause.of_rows
    sensors = () if rows else tuple(names[i] for i in slip.places)
    reached, alternatives_, ranking_ = 0.0, [], []
    for name, places, share in posterior(slip):
        own = () if rows else tuple(names[i] for i in places)
        ranking_.append(Rival(name, own, share, float(np.sqrt(2 * slip.evidence))))
        if reached < CREDIBLE and name != slip.cause.identifier and name not in alternatives_:
            alternatives_.append(name)
        reached += share
    shown = {f"row {k}": float(p + 1) for k, p in enumerate(slip.places, 1)} if rows else {}
    return Finding(
        cause=slip.cause.identifier,
        sensors=sensors,
        amplitude=(),
        sigma=(),
        units=(),
        nonlinear=shown,
        nonlinear_each=(shown,),
        p_value=float(np.exp(-slip.evidence)),
        strength=float(np.sqrt(2 * slip.evidence)),
        alternatives=tuple(alternatives_),
        separations=(),
        ranking=tuple(ranking_[:8]),
        sentence=sentence(slip.cause, sensors),
        advice=slip.cause.advice,
        parity=None,
        new=None,
    )


def clip_findings(clips: Sequence[Clip], session: CalibrationSession, baseline: Baseline) -> tuple[Finding, ...]:
    """Clipped sensors of a session as it came, as one finding: every limit at the input, with the noise of a reading.

    ``baseline``: of the session put right.
    """
    inputs = np.abs(measured(session)[0] / baseline.parameters.scale)
    found = [(c.cause, clip_finding(c, float(inputs[c.rows[0], c.sensor]), baseline)) for c in clips]
    return tuple(merged(found))


def clip_finding(clip: Clip, limit: float, baseline: Baseline) -> Finding:
    """One sensor clipped on one side at a limit, m/s² or rad/s at the input."""
    cause, sensor = clip.cause, baseline.session.sensors[clip.sensor]
    unit = "m/s²" if sensor.kind == ACCELEROMETER else "rad/s"
    shown = {unit: limit, "side": clip.side}
    return Finding(
        cause=cause.identifier,
        sensors=(sensor.name,),
        amplitude=(limit,),
        sigma=(float(np.sqrt(np.median(baseline.variance[:, clip.sensor]))),),
        units=(unit,),
        nonlinear=shown,
        nonlinear_each=(shown,),
        p_value=clip.p_value,
        strength=clip.strength,
        alternatives=(),
        separations=(),
        ranking=(Rival(cause.identifier, (sensor.name,), 1.0, clip.strength),),
        sentence=sentence(cause, (sensor.name,)),
        advice=cause.advice,
        parity=None,
        new=None,
    )


def structures(state: Search) -> tuple[Structure, ...]:
    """Unexplained structure and where it lives."""
    names = [s.name for s in state.baseline.session.sensors]
    patterns = [
        Structure(
            where=f.best.cause.where(f.best.shape) if isinstance(f.best.cause, Pattern) else "",
            sensors=tuple(names[i] for i in f.best.shape.sensors),
            p_value=f.p_family,
            strength=f.best.strength,
        )
        for f in state.structures
    ]
    uneven = [Structure(lives(s), (names[s.sensor],), s.p_value, s.strength) for s in state.serial]
    return (*patterns, *uneven)


def lives(left_over: Serial) -> str:
    """Where a left-over lives that fits no pattern, in words."""
    if left_over.evidence > PLAIN:
        return f"smooth along {left_over.order}, in no pattern known"
    return f"larger than stated, as well noise as smooth along {left_over.order}"


def entry_finding(entry: WrongEntry) -> Finding:
    """An entry of the record that the nominal axes show to be wrong."""
    return Finding(
        cause=entry.cause.identifier,
        sensors=(),
        amplitude=(entry.amplitude,),
        sigma=(entry.sigma,),
        units=entry.cause.units,
        nonlinear={},
        nonlinear_each=({},),
        p_value=entry.p_value,
        strength=entry.strength,
        alternatives=(),
        separations=(),
        ranking=(),
        sentence=entry.cause.sentence,
        advice=entry.cause.advice,
        parity=None,
        new=None,
    )
