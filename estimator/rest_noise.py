"""The standard error of the mean of a rest, from the spectrum that the rests themselves show.

Theory
------
Noise that hangs together makes a mean worse than sd/√n, and what hangs together for about as long as the rest is hidden
from its own scatter: the mean takes it along. So the spectrum is measured and followed down to the mean. Each rest is
cut into B blocks; the discrete cosine transform of the block means has energies I_k, k = 1 … B − 1, at k half waves a
rest, nearly independent for stationary noise, each χ² of one degree of freedom a rest times the spectrum

    S_k = a_0·M_0k + a_j·M_jk

of white noise and, if there is any, exponentially correlated noise (Gauss–Markov) of a time τ_j. The times double
from a block to two rests: what lasts shorter is white to the blocks, what lasts longer hardly changes within a rest
and belongs to the repeatability from position to position. The channels of a kind share the time, each with sizes of
its own, which maximise the likelihood of all rests together (Whittle 1953, Ark. Mat. 2, 423), by the ascent of
Févotte & Idier (2011, Neural Comput. 23, 2421). The times, and none, are weighed by their likelihood and the price of
one more size a channel (Schwarz 1978, Ann. Statist. 6, 461), and the variance of a mean is the mean over them of
a_0/n + a_j·v_j, n samples a rest and

    v = 2x·(1 − x·(1 − e^{−1/x})),    x the time in rests.

Never less than the sd of samples over √n.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.fft import dct

from estimator.session import Array

Indices = NDArray[np.intp]

BLOCKS = 16
"""Blocks of a rest: five octaves of correlation times."""

ROUNDS = 60
"""Rounds of the ascent: two sizes settle to a per cent in some dozens."""

RESTLESS = 3.0
"""Energy of a rest over all waves and channels, in usual ones, from which it has a standard error of its own: some
dozens of degrees of freedom do not reach it by chance."""

PASSES = 3
"""Times that the restless are looked for: one hides another only once or twice."""


MOST = 256
"""Rests that the sizes are fitted to, evenly chosen where there are more: sizes of a sensor are then known to 3 %."""


@dataclass(frozen=True, eq=False)
class Waves:
    """Spectral data of n rests of m channels. B blocks a rest."""

    value: Array
    """(n, B − 1, m) cosine transform z of the block means, unit of the readings; I = z²."""
    samples: Array
    """(n,) samples of each rest, without unit."""
    least: Array
    """(n, m) variance of the mean if the samples were independent, unit of the readings squared."""
    inside: Array
    """(n, m) variance of the mean from the scatter within the blocks, unit of the readings squared: the part that is
    faster than they are.
    """

    @property
    def known(self) -> Array:
        """(n,) bool: rests of more than a single sample."""
        return np.asarray(np.isfinite(self.value).all(axis=(1, 2)))


def block_count(samples: Indices) -> int | None:
    """B of rests of ``samples`` (n,), without unit: as many as the shortest has; None where all are single samples."""
    return None if samples.max() < 2 else int(np.clip(samples[samples > 1].min(), 2, BLOCKS))


def waves(readings: Array, start: Indices, stop: Indices) -> Waves | None:
    """The waves of readings (R, m), any unit, in rests from ``start`` to ``stop`` (n,), without unit; None where all
    are too short to have a scatter.
    """
    samples = stop - start
    count = block_count(samples)
    if count is None:
        return None
    means = np.full((len(start), count, readings.shape[1]), np.nan)
    variance = np.full((len(start), readings.shape[1]), np.nan)
    held = np.broadcast_to(samples[:, None], variance.shape).copy()
    for i in np.flatnonzero(samples > 1):
        rest = readings[start[i] : stop[i]]
        length = samples[i] // count
        means[i] = rest[: length * count].reshape(count, length, -1).mean(axis=1)
        variance[i] = rest.var(axis=0, ddof=1)
        for j in np.flatnonzero(np.isnan(variance[i])):
            x = rest[:, j]
            known = np.isfinite(x)
            held[i, j] = max(np.count_nonzero(known), 1)
            of_blocks = [b[np.isfinite(b)] for b in x[: length * count].reshape(count, length)]
            means[i, :, j] = [b.mean() if len(b) else x[known].mean() for b in of_blocks]
            variance[i, j] = x[known].var(ddof=min(held[i, j] - 1, 1))
    return waves_of(means, variance, samples, held)


def waves_of(means: Array, variance: Array, samples: Indices, held: Array | None = None) -> Waves:
    """The waves of block means (n, B, m), variances (n, m) of one sample, units of the readings (squared), and
    ``samples`` (n,), of which each channel ``held`` (n, m); all unless given.

    NaN where a rest is a single sample. White noise of which some samples are left out is white noise of fewer, larger
    ones: the waves show it, and what a mean has follows from them.
    """
    z, count = dct(means, norm="ortho", axis=1)[:, 1:], means.shape[1]
    n = samples[:, None] if held is None else held
    within = (n - 1) * variance - (n // count) * (z**2).sum(axis=1)
    return Waves(z, samples, variance / n, np.maximum(within, 0.0) / (np.maximum(n - count, 1) * n))


def mixture(samples: Array, count: int) -> tuple[Array, Array]:
    """Spectra M (n, B − 1, J) and variances v (n, J) of the mean, each for a unit of one of J noises, in rests (n,).

    The first is white, of variance one a sample; the others correlated, of variance one, their times 1/B … 2 of the
    longest rest.
    """
    times = samples.max() / count * 2.0 ** np.arange(int(np.log2(count)) + 2)
    ratio = (samples[:, None] / count) / times
    transform = dct(np.eye(count), norm="ortho", axis=0)[1:]
    lag = np.abs(np.subtract.outer(np.arange(count), np.arange(count)))
    near = 2 / ratio**2 * (ratio + np.expm1(-ratio))
    far = (np.expm1(-ratio) / ratio) ** 2
    decay = np.exp(-ratio[..., None, None] * np.maximum(lag - 1, 0))
    covariance = np.where(lag == 0, near[..., None, None], far[..., None, None] * decay)
    correlated = np.einsum("ka,njab,kb->nkj", transform, covariance, transform)
    white = np.broadcast_to((count / samples)[:, None, None], (len(samples), count - 1, 1))
    x = times / samples[:, None]
    mean = 2 * x * (1 + x * np.expm1(-1 / x))
    return np.concatenate([white, correlated], axis=-1), np.concatenate([1 / samples[:, None], mean], axis=-1)


@dataclass(frozen=True, eq=False)
class Tilting:
    """Possible tilts of the block within its rests (`estimator.rest_tilt`)."""

    response: Array
    """(n, m, 2) L, change of the readings with the two components of the tilt, unit of the readings per rad."""
    count: int
    """Waves k = 1 … that a tilt may explain; the others are the sensors' own."""

    def at(self, chosen: Array) -> "Tilting":
        """The tilting of the ``chosen`` rests, as they index (n,)."""
        return self if not self.count else Tilting(self.response[chosen], self.count)


STEADY = Tilting(np.zeros((0, 0, 2)), 0)
"""A block that does not tilt."""


@dataclass(frozen=True, eq=False)
class WeighedWaves:
    """Waves (n, B − 1, m) weighed by their spectrum, what a tilt may explain left out."""

    pull: Array
    """(n, B − 1, m) P·z, per unit of the readings."""
    left: Array
    """(n, B − 1, m) diagonal of P, per unit of the readings squared."""
    log: float
    """ln det of the covariance of what is left, but for a constant."""


def tilts_of(z: Array, S: Array, response: Array) -> tuple[Array, Array, Array]:
    """Tilts (n, k, 2) that fit waves z (n, k, m) of spectrum S best, rad; how they lean on z (n, k, m, 2), and their
    information (n, k, 2, 2), rad⁻²."""
    weighted = response[:, None] / S[..., None]
    information = np.swapaxes(weighted, -1, -2) @ response[:, None]
    lean = weighted @ np.linalg.inv(information)
    return (z[..., None, :] @ lean)[..., 0, :], lean, information


def weighed(z: Array, S: Array, tilting: Tilting) -> WeighedWaves:
    """Weighs waves z (n, B − 1, m), any unit, by their spectrum S, its square."""
    S = np.where(S > 0, S, 1.0)  # readings that never change
    pull, left, log = z / S, 1 / S, float(np.log(S).sum())
    if tilting.count:
        low = np.s_[:, : tilting.count]
        tilts, lean, information = tilts_of(z[low], S[low], tilting.response)
        explained = (tilting.response[:, None] @ tilts[..., None])[..., 0]
        pull[low] -= explained / S[low]
        left[low] -= (lean * tilting.response[:, None]).sum(axis=-1) / S[low]
        log += float(np.linalg.slogdet(information)[1].sum())
    return WeighedWaves(pull, left, log)


def fitted(z: Array, spectra: Array, tilting: Tilting) -> Array:
    """(J, m) the a_j of greatest likelihood of waves z (n, B − 1, m) under spectra (n, B − 1, J), units squared."""
    share = spectra.mean(axis=(0, 1))
    a = (z**2).mean(axis=(0, 1)) / (share[:, None] * len(share))
    for _ in range(ROUNDS if len(share) > 1 or tilting.count else 1):
        w = weighed(z, spectra @ a, tilting)
        up = np.tensordot(spectra, w.pull**2, axes=([0, 1], [0, 1]))
        a = a * np.sqrt(up / np.tensordot(spectra, w.left, axes=([0, 1], [0, 1])))
    return a


def log_likelihood(z: Array, S: Array, tilting: Tilting) -> float:
    """Log likelihood of waves z (n, B − 1, m) under a spectrum of the same shape, units squared; all channels
    together.
    """
    w = weighed(z, S, tilting)
    return -0.5 * (w.log + float((z * w.pull).sum()))


@dataclass(frozen=True, eq=False)
class Noises:
    """White noise alone, and with correlated noise of each time: K models."""

    amplitude: Array
    """(K, J, m) a_j, unit of the readings squared."""
    weight: Array
    """(K,) probability of each, without unit."""

    def over(self, shapes: Array) -> Array:
        """(n, …, m) mean over the models of shapes (n, …, J), unit of the readings squared."""
        return np.tensordot(shapes, np.tensordot(self.weight, self.amplitude, axes=1), axes=1)


def noises(z: Array, spectra: Array, tilting: Tilting) -> Noises:
    """The models under which waves z (n, B − 1, m) are likely; spectra (n, B − 1, J) of one noise each."""
    K, m = spectra.shape[-1], z.shape[-1]
    amplitude, score = np.zeros((K, K, m)), np.zeros(K)
    for k in range(K):
        used = [0, k] if k else [0]
        amplitude[k, used] = fitted(z, spectra[..., used], tilting)
        prior = 0.5 * m * np.log(z[..., 0].size) + np.log(K - 1) if k else 0.0
        score[k] = log_likelihood(z, spectra @ amplitude[k], tilting) - prior
    weight = np.exp(score - score.max())
    return Noises(amplitude, weight / weight.sum())


@dataclass(frozen=True, eq=False)
class RestNoise:
    """Noise of m channels by the waves of n rests."""

    variance: Array
    """(n, m) variance of the mean of each rest, unit of the readings squared."""
    spectrum: Array
    """(k, B − 1, m) spectrum of the k rests of more than a single sample, unit of the readings squared; 1 of readings
    that never change.
    """


def rest_noise(waves: Waves, tilting: Tilting = STEADY) -> RestNoise:
    """Spectrum and variance of the means; a restless rest has its own scale."""
    known, z = waves.known, waves.value
    spectra, means = mixture(waves.samples.astype(float), z.shape[1] + 1)
    unrest, variance = np.ones(len(known)), np.zeros_like(waves.least)
    freedom = z[0].size - 2 * tilting.count
    for _ in range(PASSES):
        calm = known & (unrest < RESTLESS)
        some = np.flatnonzero(calm)[:: -(-np.count_nonzero(calm) // MOST)]
        likely = noises(z[some], spectra[some], tilting.at(some))
        variance, S = likely.over(means), likely.over(spectra[known])
        w = weighed(z[known], S, tilting.at(known))
        unrest[known] = (z[known] * w.pull).sum(axis=(1, 2)) / freedom
        if np.array_equal(calm, known & (unrest < RESTLESS)) or not (known & (unrest < RESTLESS)).any():
            break
    scale = np.where(unrest < RESTLESS, 1.0, unrest)
    least = np.where(known[:, None], waves.least, 0.0)
    S = np.where(S > 0, S, 1.0) * scale[known, None, None]
    return RestNoise(np.maximum(variance * scale[:, None], least), S)
