"""A name rests on the stated noise of the sensors that carry it: it must hold whether or not that noise is right.

Theory
------
Let T be what a name explains, χ² with q degrees of freedom where nothing acts and the stated noise is right, and E with
f degrees of freedom what all names leave of the sensor. Where its stated noise is wrong by a factor that nobody knows,
(T/q)/(E/f) is F with q and f. T and E are independent given the noise, so that without an effect

    P(T ≥ t | E) = (1 − w) P(χ²_q ≥ t) + w P(F_{q,f} ≥ (t/q)/(E/f)),        w/(1 − w) = π/(1 − π) · B(E)

with π how often stated noise is wrong and B(E) the Bayes factor of noise larger than stated against noise as stated,
½(E − f) − ½ f ln(E/f) − ½ ln(f/2) in logarithms. What a name carries on several sensors is at the mercy of each.

Where the β error of a row is shared, a sensor that is believed too much draws it to its own readings: E is then hardly
too large, and what the sensor scatters shows in all. So on a block that is not too large ½(E − f) − ½ f ln(E/f) is the
gain in restricted likelihood of the whole session, which it is where nothing is shared (`likelihood.py`).
"""

from dataclasses import replace

import numpy as np
from scipy.special import expit, logit

from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.likelihood import log_likelihood_ratio
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.diagnosis.selection.common_or_own import rescored_detections
from estimator.diagnosis.selection.excess_noise import sensor_scatter, with_unknown_noise
from estimator.diagnosis.selection.ranking import conditional_p_value, extended_basis
from estimator.diagnosis.selection.search_state import LEVEL, Detection, SearchState
from estimator.diagnosis.selection.start import with_residual_scatter
from estimator.diagnosis.signatures.lasting import MANY
from estimator.diagnosis.signatures.noise import NoiseClaim
from estimator.diagnosis.signatures.products import Projected
from estimator.diagnosis.signatures.scores import rescored, tail
from estimator.session import Array

WRONG = 0.03
"""π, how often a sensor's standard errors are too small, as sd/√n of samples that hang together is: so often that one
block of six in six has such a sensor."""

STRONG = float(np.log(10))
"""ln B(E) that is strong evidence of larger noise (Jeffreys). Then E/f is not its scale: readings that are believed too
much pull what all share of a row to themselves, and the fit must be made again."""

FEWEST = 2.0
"""Degrees of freedom below which a sensor's residual does not estimate its noise: the file's figure is all there is."""


def doubtful_claims(state: SearchState) -> tuple[NoiseClaim, ...]:
    """Sensors whose stated noise names may not rest on: it is too small by strong evidence, or may be and a name would
    then not hold."""
    ratio, larger = evidence_of_larger_noise(state)
    sensors = sorted({i for f in state.detections for i in doubted_for(state, f, larger)})
    freedom, kinds = sensor_scatter(state)[1], state.baseline.setting.kinds
    return tuple(NoiseClaim(kinds[i], (i,), float(ratio[i]), float(freedom[i])) for i in sensors)


def doubted_for(state: SearchState, detection: Detection, larger: Array) -> set[int]:
    """Sensors that one name may not rest on; ``larger`` (m,) ln B(E)."""
    sensors = [i for i in detection.best.sensors or range(len(larger)) if np.isfinite(larger[i])]
    at_its_mercy = {
        i: float(expit(logit(WRONG) + larger[i])) * p_value_in_unknown_noise(state, detection, i) for i in sensors
    }
    bound = LEVEL / max(len(sensors), 1) if sum(at_its_mercy.values()) >= LEVEL else np.inf
    return {i for i in sensors if larger[i] > STRONG or at_its_mercy[i] >= bound}


def hold_jointly(state: SearchState, names: tuple[Detection, ...]) -> bool:
    """Whether names of another search are all significant beside one another in the noise of this one."""
    seen = rescored_detections(state, names)
    joint = replace(state, detections=seen)
    again = [rescored(state.residuals, f.best, joint.attributed(without=f)) for f in seen]
    return len(seen) == len(names) and all(
        conditional_p_value(f, s, state.families) < LEVEL for f, s in zip(names, again, strict=True)
    )


def p_value_in_unknown_noise(state: SearchState, detection: Detection, sensor: int) -> float:
    """Family-wise p-value of a name beside the others, the noise of a sensor known from its readings alone."""
    doubting, attributed = with_unknown_noise(state, sensor), state.attributed(without=detection)
    basis = extended_basis(attributed, detection.best.trace)[:, attributed.shape[1] :]
    p_value = tail(Projected.of(doubting.residuals, attributed), next(iter(detection.best.sensors), -1), basis)
    return conditional_p_value(detection, replace(detection.best, p_value=p_value), state.families)


def evidence_of_larger_noise(state: SearchState) -> tuple[Array, Array]:
    """(m,) variance over the stated one, and (m,) ln B(E) of noise larger than stated; −∞ where none is stated or
    it cannot be estimated."""
    energy, freedom = sensor_scatter(state)
    f = np.maximum(freedom, FEWEST)
    ratio = energy / f
    more = np.maximum(ratio, 1.0)
    gained = 0.5 * f * (more - 1 - np.log(more))
    if state.detections and state.sensor_count <= MANY:
        joint = with_free_effects(state)
        plain = WhitenedResiduals.of(joint)
        for i in sensors_with_detections(state):
            scaled = with_residual_scatter(joint, [[i]])
            factor = float(np.median(scaled.variance[:, i] / joint.variance[:, i]))
            whole = log_likelihood_ratio(WhitenedResiduals.of(scaled), plain) if factor > 1 else 0.0
            if whole > gained[i]:
                ratio[i], gained[i] = factor, whole
    log_evidence = gained - 0.5 * np.log(f / 2)
    return ratio, np.where((freedom >= FEWEST) & ~state.baseline.unstated, log_evidence, -np.inf)


def sensors_with_detections(state: SearchState) -> set[int]:
    """Sensors of stated noise on which names rest."""
    named = {i for f in state.detections for i in f.best.sensors or range(state.sensor_count)}
    return {i for i in named if not state.baseline.unstated[i]}


def with_free_effects(state: SearchState) -> Baseline:
    """The baseline to which what was found is known but for its size: a nuisance of which nothing is known."""
    effects = np.concatenate([f.best.shape.columns for f in (*state.detections, *state.structures)], axis=-1)
    size = np.sqrt((effects**2).sum(axis=(0, 1)))
    constant = np.concatenate([state.baseline.constant, effects[..., size > 0] / size[size > 0]], axis=-1)
    unknown = np.full(constant.shape[-1] - state.baseline.constant.shape[-1], np.inf)
    return replace(
        state.baseline, constant=constant, constant_sigma=np.concatenate([state.baseline.constant_sigma, unknown])
    )
