"""How well the means of rests are known in which the block turns a little: a hand that holds it, a seat that settles.

Theory
------
A turn δθ of a block at rest moves all its accelerometers together: reading i by L_i·δ, δ the two components of δθ
across gravity, L_i (2,) known from the axes and the direction of gravity. A cosine wave of block means
(`estimator.rest_noise`) is then, of all m accelerometers,

    z = L·δ + ε,        ε independent from sensor to sensor, of the spectra S

What turns the block is no noise of the sensors, and a calibration that looks for the direction of every row finds the
mean turn as part of it: δ is unknown and without a law of its own in every wave of every rest. The likelihood of what
no turn can explain (restricted; Patterson & Thompson 1971, Biometrika 58, 545) is with D = diag(S)

    −½·(ln det D + ln det LᵀD⁻¹L + zᵀP z),        P = D⁻¹ − D⁻¹L·(LᵀD⁻¹L)⁻¹·LᵀD⁻¹

and the spectra of greatest likelihood are found as before, I_k/S² replaced by (P z)² and 1/S by the diagonal of P (Zhou,
Hu, Zhou & Lange 2019, J. Comput. Graph. Stat. 28, 350). m − 2 combinations a wave remain: of three accelerometers the
one along gravity, whose sensors differ from rest to rest; where all rests lie alike they cannot be told apart, and
nothing is taken out. Nor is it in waves that show no turn: the energy along L against the rest is then Fisher's F.

The mean turn itself has the variance that the waves of δ̂ = (LᵀD⁻¹L)⁻¹LᵀD⁻¹z show, followed to the mean like a
reading's. Along gravity and in gyros nothing is absorbed: there a turn, or a push, counts as noise.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from estimator.rest_noise import RestNoise, Turning, Waves, rest_noise, turns_of
from estimator.session import Array

CHANCE = 0.05
"""Probability by which waves of a block that does not turn are taken to: it costs some accuracy of the errors, and a
turn that is missed makes them a third too large."""

APART = 10.0
"""Degrees of freedom that the own noise of every sensor must keep: its sigma is then known to a fifth."""


@dataclass(frozen=True, eq=False)
class MeanErrors:
    """Of the means of n rests of m channels."""

    own: Array
    """(n, m) standard error of what each channel has alone, unit of the readings."""
    turn: Array
    """(n,) standard error of the block's mean turn about each axis across gravity, rad; 0 where it shows none."""


def errors_of_means(waves: Waves, answer: Array | None) -> MeanErrors:
    """Of rests in which two turns move the readings by ``answer`` (n, m, 2), their unit per rad; None: none does."""
    plain = rest_noise(waves)
    count = 0 if answer is None else turning_waves(waves, plain, answer)
    if answer is None or not count:
        return MeanErrors(np.sqrt(plain.variance), np.zeros(len(waves.samples)))
    own = rest_noise(replace(waves, least=waves.inside), Turning(answer, count))
    turns = np.full((*waves.value.shape[:2], 2), np.nan)
    turns[waves.known] = turns_of(waves.value[waves.known], own.spectrum, answer[waves.known])[0]
    least = np.zeros((len(turns), 2))
    turn = rest_noise(Waves(turns, waves.samples, least, least)).variance
    return MeanErrors(np.sqrt(own.variance), np.sqrt(turn.mean(axis=1)))


def turning_waves(waves: Waves, plain: RestNoise, answer: Array) -> int:
    """Waves k = 1 … up to the fastest octave in which the block plainly turns; 0 where that cannot be told."""
    z, L = waves.value[waves.known], answer[waves.known]
    if not told_apart(L / np.sqrt(plain.spectrum.mean(axis=1))[..., None], z.shape[1]):
        return 0
    turns, _, information = turns_of(z, plain.spectrum, L)
    along = (turns[..., None, :] @ information @ turns[..., None])[..., 0, 0]
    across = (z**2 / plain.spectrum).sum(axis=-1) - along
    turning, m = 0, z.shape[2]
    for first in 2 ** np.arange(np.log2(z.shape[1] + 1)).astype(int):
        octave = np.s_[:, first - 1 : 2 * first - 1]
        freedom = 2 * along[octave].size
        ratio = (m - 2) / 2 * along[octave].sum() / across[octave].sum()
        if special.fdtrc(freedom, freedom * (m - 2) / 2, ratio) < CHANCE:
            turning = min(2 * first - 1, z.shape[1])
    return turning


def told_apart(answer: Array, count: int) -> bool:
    """Whether ``count`` waves a rest tell the own noise of every sensor beside turns that it answers to by (n, m, 2) standard
    deviations per rad."""
    m = answer.shape[1]
    if m < 3 or not np.isfinite(answer).all():
        return False
    complement = np.eye(m) - answer @ np.linalg.pinv(answer)
    overlap = (complement**2).sum(axis=0)
    values, vectors = np.linalg.eigh(overlap)
    if values[0] <= np.finfo(float).eps * m * values[-1]:
        return False
    return bool(count / (vectors**2 / values).sum(axis=1).max() >= APART)
