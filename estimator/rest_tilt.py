"""The uncertainty of the means of rests in which the block tilts a little: held by hand, or on a seat that settles.

Theory
------
A rotation δθ of a block at rest moves all its accelerometers together: reading i by L_i·δ, δ the tilt (the two
components of δθ across gravity), L_i (2,) known from the axes and the direction of gravity. A cosine wave of block
means (`estimator.rest_noise`) is then, of all m accelerometers,

    z = L·δ + ε,        ε independent from sensor to sensor, of the spectra S

What tilts the block is no noise of its sensors, and a calibration that looks for the direction of every row finds the
mean tilt as part of it. So δ is unknown, without a law, in every wave of every rest, and the likelihood is that of what
no tilt explains (restricted; Patterson & Thompson 1971, Biometrika 58, 545): with D = diag(S)

    −½·(ln det D + ln det LᵀD⁻¹L + zᵀP z),        P = D⁻¹ − D⁻¹L·(LᵀD⁻¹L)⁻¹·LᵀD⁻¹

The spectra of greatest likelihood are found as before, with (P z)² for I/S² and the diagonal of P for 1/S (Zhou, Hu,
Zhou & Lange 2019, J. Comput. Graph. Stat. 28, 350). Each wave keeps m − 2 combinations: of three accelerometers the one
along gravity, which is another in every orientation. Where all rests lie alike the sensors cannot be separated, and
nothing is taken out; nor is it in waves without a tilt, where the energy along L is to the rest as Fisher's F.

The mean tilt itself varies as the waves of δ̂ = (LᵀD⁻¹L)⁻¹LᵀD⁻¹z show, followed to the mean like a reading's. Along
gravity nothing is absorbed: a push counts as the sensors' noise, and so does a rotation in gyros.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy import special

from estimator.rest_noise import RestNoise, Tilting, Waves, rest_noise, tilts_of
from estimator.session import Array

CHANCE = 0.05
"""Probability by which a tilt is seen in an octave that has none: that costs some accuracy of the errors, where a tilt
that is missed makes them a third too large."""

APART = 10.0
"""Degrees of freedom that the own noise of every sensor must keep: its sigma is then known to a fifth."""

FLATTEST = 1e-6
"""Ratio of the responses to the two tilts below which the sensors show but one of them."""

TINY = float(np.finfo(float).tiny)
"""Keeps readings that never change from a division by nothing."""


@dataclass(frozen=True, eq=False)
class MeanErrors:
    """Standard errors of the means of n rests of m channels."""

    alone: Array
    """(n, m) standard error of what each channel has alone, unit of the readings."""
    tilt: Array | None = None
    """(n,) standard error of each component of the block's mean tilt, rad; None where it shows none."""


def errors_of_means(waves: Waves, response: Array | None) -> MeanErrors:
    """Errors in rests in which a tilt moves the readings by ``response`` (n, m, 2), their unit per rad; None: none
    does.
    """
    plain = rest_noise(waves)
    count = 0 if response is None else tilting_waves(waves, plain, response)
    if response is None or not count:
        return MeanErrors(np.sqrt(plain.variance))
    noise = rest_noise(replace(waves, least=waves.inside), Tilting(response, count))
    tilts = np.full((*waves.value.shape[:2], 2), np.nan)
    tilts[waves.known] = tilts_of(waves.value[waves.known], noise.spectrum, response[waves.known])[0]
    least = np.zeros((len(tilts), 2))
    tilt = rest_noise(Waves(tilts, waves.samples, least, least)).variance
    return MeanErrors(np.sqrt(noise.variance), np.sqrt(tilt.mean(axis=1)))


def tilting_waves(waves: Waves, plain: RestNoise, response: Array) -> int:
    """Waves k = 1 … up to the fastest octave in which the block plainly tilts; 0 where that cannot be estimated."""
    z, L = waves.value[waves.known], response[waves.known]
    if not are_separable(L / np.sqrt(plain.spectrum.mean(axis=1))[..., None], z.shape[1]):
        return 0
    tilts, _, information = tilts_of(z, plain.spectrum, L)
    along = (tilts[..., None, :] @ information @ tilts[..., None])[..., 0, 0]
    across = (z**2 / plain.spectrum).sum(axis=-1) - along
    tilting, m = 0, z.shape[2]
    for first in 2 ** np.arange(np.log2(z.shape[1] + 1)).astype(int):
        octave = np.s_[:, first - 1 : 2 * first - 1]
        freedom = 2 * along[octave].size
        ratio = (m - 2) / 2 * along[octave].sum() / max(across[octave].sum(), TINY)
        if special.fdtrc(freedom, freedom * (m - 2) / 2, ratio) < CHANCE:
            tilting = min(2 * first - 1, z.shape[1])
    return tilting


def are_separable(response: Array, count: int) -> bool:
    """Whether ``count`` waves a rest separate the sensors' own noises, beside a tilt that moves the readings by
    ``response`` (n, m, 2), their standard deviations per rad.
    """
    m, spread = response.shape[1], np.linalg.svd(response, compute_uv=False)
    if m < 3 or (spread[:, 1] <= FLATTEST * spread[:, 0]).any():
        return False
    complement = np.eye(m) - response @ np.linalg.pinv(response)
    overlap = (complement**2).sum(axis=0)
    values, vectors = np.linalg.eigh(overlap)
    if values[0] <= np.finfo(float).eps * m * values[-1]:
        return False
    return bool(count / (vectors**2 / values).sum(axis=1).max() >= APART)
