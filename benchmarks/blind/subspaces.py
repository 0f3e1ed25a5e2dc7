"""Rivals that look through all signatures of the catalogue: matched subspaces, and exhaustive Bayes.

Theory
------
A matched subspace detector (Scharf and Friedlander 1994) takes the signature whose share T of the residual's energy is
least likely to be noise: −ln p, p times the number of places of its cause. Exhaustive Bayes weighs every signature by
the likelihood ratio Λ(T; s) of `benchmarks.study.detection`, averaged over the strengths s, the causes and the places
that the generator draws: of one effect nobody without more knowledge finds more. Both look a second time at what the
first name leaves.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from scipy.special import chdtrc, gammaln, logsumexp

from benchmarks.blind.given import Claim, Given
from benchmarks.study.detection import energy, log_likelihood_ratio
from benchmarks.study.examine import SHARES
from benchmarks.study.signatures import Signatures, SignatureScores
from estimator.causes.environment import BiasJump
from estimator.diagnosis.explanation.extended_model import amplitudes
from estimator.diagnosis.explanation.rivals import CREDIBLE
from estimator.diagnosis.posterior.explained import Detection, ExplainedSession, Scored, begin
from estimator.diagnosis.posterior.term import Place
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.remaining import remaining_of_sensors
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array
from tests.blind.cases import FAINTEST, STRONGEST, WEAKEST

NAMES = 2
"""Most that one session gets."""
STRENGTHS = np.concatenate([np.geomspace(FAINTEST, WEAKEST, 6), np.geomspace(WEAKEST, STRONGEST, 12)])
OF_STRENGTH = np.repeat([SHARES["weak"] / 6, SHARES["single"] / 12], [6, 12]) / (SHARES["weak"] + SHARES["single"])
"""Each strength's share of the prior."""
NOISIER = np.geomspace(1.2, 20.0, 24)
"""Factors of a sensor's noise."""
NOISE = "excess-noise"
"""A cause without a signature: a variance."""
UNDERFLOW = 1e-250

Choice = Callable[[Signatures, ExplainedSession], tuple[Claim, Scored | None] | None]
"""The likeliest name, and what is to be taken out before the second look; None where there is none."""


def matched(given: Given) -> list[Claim]:
    """Matched subspaces of the whole catalogue."""
    return list(_in_turn(given.signatures, given.state, _best_matched))


def one_step(given: Given) -> list[Claim]:
    """A generalised likelihood ratio (Willsky and Jones 1976): a step of one sensor at any row of the session as filed;
    what all sensors of a row share counts as the stand's, as in parity space."""
    state = begin(baseline_of(given.right.rows), (), [BiasJump()])
    return list(_in_turn(Signatures.of(state), state, _best_matched))[:1]


def chi_square(given: Given) -> list[Claim]:
    """χ² of the residuals of the session as filed: no signature is looked for."""
    return [Claim(energy(WhitenedResiduals.of(baseline_of(given.right.rows))), None)]


def bayes(given: Given) -> list[Claim]:
    """The posterior under the generator's prior."""
    return list(_in_turn(given.signatures, given.state, _likeliest))


def given_cause(given: Given) -> list[Claim]:
    """The best of each cause, for somebody who knows which one acts, the surest first; noise, by each sensor's χ²."""
    state = given.state
    seen = given.signatures.scores(state.attributed())
    sure, cause = surprise(given.signatures, seen), seen.cause
    best = [np.flatnonzero(cause == c) for c in dict.fromkeys(cause)]
    chosen = [int(k[np.argmax(sure[k])]) for k in best]
    claims = [Claim(float(sure[k]), finding(_beside(state, seen.scored(k)))) for k in chosen]
    return sorted([*claims, *_noisiest(given.signatures, state)], key=lambda claim: -claim.statistic)


def _in_turn(known: Signatures, state: ExplainedSession, choose: Choice) -> Iterator[Claim]:
    """The first name, and the second in what the first leaves."""
    for _ in range(NAMES):
        found = choose(known, state)
        if found is None:
            return
        yield found[0]
        if found[1] is None:
            return
        state = _beside(state, found[1])


def _beside(state: ExplainedSession, best: Scored) -> ExplainedSession:
    """The search with one more signature found."""
    return replace(state, detections=(*state.detections, Detection(best, best.p_value, ())))


def finding(state: ExplainedSession, alternatives: tuple[str, ...] = ()) -> dict[str, object]:
    """The latest of the signatures found, as an answer holds it."""
    fitted, best = amplitudes(state), state.detections[-1].best
    place = slice(fitted.slices[-1].start, fitted.slices[-1].start + len(best.cause.units))
    sigma = np.sqrt(np.diagonal(fitted.covariance)[place])
    amplitude, sigma = best.cause.reported(state.baseline.setting, best.shape, fitted.value[place], sigma)
    return {
        "cause": best.cause.identifier,
        "sensors": [state.names[i] for i in best.sensors],
        "amplitude": list(map(float, amplitude)),
        "sigma": list(map(float, sigma)),
        "alternatives": list(alternatives),
    }


def surprise(known: Signatures, seen: SignatureScores) -> Array:
    """(k,) −ln p of every shape, the choice among causes and among the places of its own included."""
    many = np.array([known.families * known.places[c] for c in seen.cause])
    return -log_tail(seen.statistic, seen.freedom) - np.log(many)


def log_tail(statistic: Array, freedom: Array) -> Array:
    """(k,) ln p of χ², beyond the smallest number too (DLMF 8.11.2)."""
    a, x = np.maximum(freedom, 1) / 2, np.maximum(statistic, 1e-12) / 2
    far, p = (a - 1) * np.log(x) - x - gammaln(a), chdtrc(2 * a, 2 * x)
    return np.where(freedom > 0, np.where(p > UNDERFLOW, np.log(np.maximum(p, UNDERFLOW)), far), 0.0)


def _best_matched(known: Signatures, state: ExplainedSession) -> tuple[Claim, Scored] | None:
    seen = known.scores(state.attributed())
    if not len(seen.cause):
        return None
    sure = surprise(known, seen)
    best = seen.scored(int(np.argmax(sure)))
    return Claim(float(sure.max()), finding(_beside(state, best))), best


def _likeliest(known: Signatures, state: ExplainedSession) -> tuple[Claim, Scored | None] | None:
    """The cause and sensors of most posterior, the other causes as alternatives until all hold `CREDIBLE` together."""
    seen = known.scores(state.attributed())
    groups = {**_weighed(known, seen), **_noisier(state)}
    if not groups:
        return None
    causes = len({cause for cause, _ in groups})
    total = float(logsumexp([ratio for ratio, _ in groups.values()]))
    ranked = sorted(groups.items(), key=lambda item: -item[1][0])
    share = np.cumsum(np.exp([ratio - total for _, (ratio, _) in ranked]))
    shown = dict.fromkeys(cause for (cause, _), _ in ranked[: int(np.searchsorted(share, CREDIBLE)) + 1])
    (cause, sensors), (_, k) = ranked[0]
    others, statistic = tuple(name for name in shown if name != cause), total - float(np.log(causes))
    if k is None:
        named = {"cause": cause, "sensors": [state.names[i] for i in sensors], "alternatives": list(others)}
        return Claim(statistic, named), None
    return Claim(statistic, finding(_beside(state, seen.scored(k)), others)), seen.scored(k)


def _weighed(known: Signatures, seen: SignatureScores) -> dict[Place, tuple[float, int | None]]:
    """ln Λ of every cause on its sensors, averaged over strengths and places, and the likeliest shape."""
    each = np.stack([log_likelihood_ratio(seen.statistic, seen.freedom, s) for s in STRENGTHS])
    ratio, counted = logsumexp(each, axis=0, b=OF_STRENGTH[:, None]), known.places
    members: dict[Place, list[int]] = {}
    for k in range(len(ratio)):
        members.setdefault(seen.group(k), []).append(k)
    return {
        group: (float(logsumexp(ratio[k])) - float(np.log(counted[group[0]])), k[int(np.argmax(ratio[k]))])
        for group, k in members.items()
    }


def _noisier(state: ExplainedSession) -> dict[Place, tuple[float, int | None]]:
    """ln Λ of each sensor's noise being larger than stated, averaged over factors and sensors."""
    square, freedom = _left_of_sensors(state)
    ratio = 0.5 * np.outer(square, 1 - NOISIER**-2.0) - np.outer(freedom, np.log(NOISIER))
    mean = logsumexp(ratio, axis=1) - np.log(len(NOISIER) * len(ratio))
    return {(NOISE, (i,)): (float(mean[i]), None) for i in _stated(state)}


def _noisiest(known: Signatures, state: ExplainedSession) -> Iterator[Claim]:
    """The sensor whose residuals lie farthest beyond its stated noise, if any states it."""
    square, freedom = _left_of_sensors(state)
    sure = -log_tail(square, freedom) - np.log(known.families * len(square))
    if stated := _stated(state):
        i = max(stated, key=lambda k: sure[k])
        yield Claim(float(sure[i]), {"cause": NOISE, "sensors": [state.names[i]]})


def _left_of_sensors(state: ExplainedSession) -> tuple[Array, Array]:
    """(m,) energy, dimensionless, and (m,) degrees of freedom that what was found leaves of every sensor."""
    found = [f.best.shape.columns for f in state.detections]
    return remaining_of_sensors(state.residuals, np.concatenate(found, axis=-1) if found else None)


def _stated(state: ExplainedSession) -> list[int]:
    """Sensors whose noise the file states."""
    return [int(i) for i in np.flatnonzero(~state.baseline.unstated)]
