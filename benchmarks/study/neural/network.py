"""The network: signatures that it learns, matched to the residuals, and what their outputs say of every cause.

Theory
------
The first layers make signatures g out of what is known of every reading; each gives gᵀv / |g|, of unit variance where
nothing acts: v are the residuals weighted by the inverse of their covariance, |g| is what the baseline leaves of the
signature. Kernels that stand at every row in turn find what happens once. One head with the same weights for all
sensors, and one for what they share, turn these outputs into a posterior over {sound, a cause of one sensor, of all}.

m sensors, R rows, F facts, p directions that the baseline absorbs; d sessions, n draws of the residuals of each. All in
units of each reading's own noise. ``xp`` is numpy, or jax.numpy where derivatives are wanted.
"""

from functools import lru_cache
from itertools import pairwise
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

import numpy as np

from estimator.causes.contract import Setting
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import GYROSCOPE, Array

Weights = dict[str, Array]
ROWS = 72
"""Most rows of a session."""
STEEP = 5.0
"""The strength for which a moved kernel's outputs are averaged over its places."""
ABSORBED = 1e-4
"""Least share of a signature's square that the baseline must leave for it to count."""
LAGS = (0.1, 0.4)
"""Time constants of late temperatures, of the session's length."""
SIGNATURES, HIDDEN = 64, 96
"""Learned of one sensor and of all; width of the heads."""


class Design(NamedTuple):
    """Features of a session beside its residuals."""

    known: Array
    """(m, R, F) features of every reading: how it was held, when, how warm; 0 where the file does not say."""
    basis: Array
    """(m, R, p) basis of the part of whitened readings that the baseline absorbs."""
    direction: Array
    """(m, R) direction that the sensors of a row share."""
    removed: Array
    """(R,) the share of it that whitening takes away."""
    loud: Array
    """(m, R) sensitivity of a reading to how it is held, of the largest."""
    own: Array
    """(m, R, 5) orthonormal: what each sensor's own parameters absorb."""
    present: Array
    """(m, R) 1, and 0 where there is no reading."""


def design_of(residuals: WhitenedResiduals) -> Design:
    """The features of a fitted session on a stand."""
    R, m = residuals.baseline.residual.shape
    direction, removed = residuals.whiten.direction[..., 0], residuals.whiten.removed[:, 0]
    root = residuals.whiten.weight * np.sqrt(1 - (removed * (2 - removed))[:, None] * direction**2)
    own, size, _ = np.linalg.svd((residuals.baseline.design * root[..., None]).swapaxes(0, 1), full_matrices=False)
    loud, basis = root * residuals.baseline.setting.norm, residuals.basis[: R * m].reshape(R, m, -1)
    own = own * (size > 1e-9 * size[:, :1])[:, None]
    facts = known(residuals.baseline.setting).swapaxes(0, 1)
    return Design(facts, basis.swapaxes(0, 1), direction.T, removed, (loud / loud.max()).T, own, np.ones((m, R)))


def known(setting: Setting) -> Array:
    """(R, m, F) dimensionless."""
    axis, norm, R = setting.parameters.axis, setting.norm, setting.rows
    tilted = np.cross(setting.n, setting.d_alpha) / norm[:, None]
    moved = [np.einsum("rmk,mk->rm", by, axis) / norm for by in (setting.n, setting.d_alpha, setting.d_beta, tilted)]
    came = np.where(setting.first_of_run[:, None], 0.0, np.diff(moved[0], axis=0, prepend=moved[0][:1]))
    gyro = np.array([kind == GYROSCOPE for kind in setting.kinds]) + np.zeros((R, 1))
    shaken = standard(setting.vibration) if setting.has("vibration") else 0 * gyro
    each = np.stack([*moved, standard(came), gyro, shaken], axis=-1)
    across, turned = setting.across / norm[:, None], np.cross(setting.n, axis) / norm[:, None]
    return np.concatenate([each, across, turned, np.stack(len(norm) * [of_rows(setting)], axis=1)], axis=-1)


def of_rows(setting: Setting) -> Array:
    """(R, 12) dimensionless: what all sensors of a row share."""
    beta, time, order = setting.beta, setting.time, np.arange(setting.rows) / setting.rows
    clock = order if time is None else (time - time[0]) / np.ptp(time)
    heat = 0 * order if setting.temperature is None else standard(setting.temperature)
    lags = [np.tril(np.exp((clock - clock[:, None]) / lag)) for lag in LAGS]
    late = (heat - lag @ heat / lag.sum(axis=1) for lag in lags)
    turns = (f(k * beta) for k in (1, 2) for f in (np.sin, np.cos))
    when = (2.0 * setting.flipped - 1, order, 0 * order if time is None else clock)
    return np.stack([*turns, standard(beta), *when, heat, standard(np.gradient(heat, clock)), *late], axis=-1)


def standard(values: Array) -> Array:
    """Each column less its mean, in its standard deviation; 0 for a constant."""
    spread = values.std(axis=0)
    return (values - values.mean(axis=0)) / np.where(spread > 0, spread, 1.0)


def starting(facts: int, causes: tuple[int, int], rng: np.random.Generator) -> Weights:
    """Weights at random for c, C causes; the kernels start as one row alone and as a step."""
    widths = {name: (facts, *[SIGNATURES] * 3) for name in ("own", "all")}
    widths |= {name: (*[HIDDEN] * 3, end) for name, end in zip(("sensor", "block"), causes, strict=True)}
    w = {f"{name}{k}": normal(shape, rng) for name, all in widths.items() for k, shape in enumerate(pairwise(all))}
    w |= {f"{name}b": np.zeros(x.shape[1]) for name, x in w.items()}
    for name, seen in (("sensor", 2 * SIGNATURES + 3), ("block", 2 * SIGNATURES)):
        w |= {f"{name}-seen": normal((seen, HIDDEN), rng), f"{name}-context": normal((2 * facts + 1, HIDDEN), rng)}
    offset = np.arange(-ROWS, ROWS + 1)
    w["kernel"] = np.stack([offset == 0, offset >= 0], axis=1) + rng.normal(0, 0.01, (len(offset), 2))
    return {name: x.astype(np.float32) for name, x in w.items()}


def normal(shape: tuple[int, int], rng: np.random.Generator) -> Array:
    """Weights of a layer whose outputs are about as large as its inputs."""
    return rng.normal(0, np.sqrt(1.5 / shape[0]), shape)


def log_posterior(w: Weights, design: Design, z: Array, xp: ModuleType = np) -> Array:
    """(d, n, 1 + m·c + C) log posterior: sound, c causes of each sensor, sensor by sensor, C causes that all share.

    ``z`` (d, m, n, R) whitened residuals; the design has a leading axis d.
    """
    there, context, filters = design.present[..., None], about(design, xp), Filters.of(design, z, xp)
    one = filters(mlp(w, "own", design.known, xp) * there, xp)
    once = moved(w, filters, design, xp)
    every = filters(mlp(w, "all", design.known, xp) * there * design.loud[..., None], xp, together=True)
    seen = xp.concatenate([one, one**2 / 8, once, (z**2).mean(axis=-1)[..., None]], axis=-1)
    own = head(w, "sensor", seen, context[:, :, None], xp)
    own = xp.where(there[:, :, :1] > 0, own, -1e6).swapaxes(1, 2).reshape(*every.shape[:2], -1)
    shared = head(w, "block", xp.concatenate([every, every**2 / 8], axis=-1), context.mean(axis=1)[:, None], xp)
    logits = xp.concatenate([0 * shared[..., :1], own, shared], axis=-1)
    return logits - log_sum(logits, xp)


class Filters(NamedTuple):
    """Filters that signatures are matched to."""

    v: Array
    """(d, m, n, R) residuals weighted by the inverse of their covariance."""
    taken: Array
    """(d, m, R, p) basis of the part that the baseline absorbs."""
    shared: Array
    """(d, m, R, 1) direction that the sensors of a row share."""
    own: Array
    """(d, m, R, 5) orthonormal basis of the part that each sensor's own parameters absorb."""

    @classmethod
    def of(cls, design: Design, z: Array, xp: ModuleType) -> "Filters":
        """The filters, from arguments as in `log_posterior`."""
        removed, direction = design.removed[:, None, :, None], design.direction[..., None]
        both = xp.concatenate([z.swapaxes(-1, -2), design.basis], axis=-1)
        size = 1 / xp.sqrt(1 - removed * (2 - removed) * direction**2)
        both = size * (both - removed * direction * (direction * both).sum(axis=1, keepdims=True))
        v, taken = both[..., : z.shape[2]].swapaxes(-1, -2), both[..., z.shape[2] :]
        return cls(v, taken, xp.sqrt(removed * (2 - removed)) * direction * size, design.own)

    def __call__(self, g: Array, xp: ModuleType, *, together: bool = False) -> Array:
        """(d, m, n, K) outputs of signatures g (d, m, R, K), each of one sensor; (d, n, K) of all sensors together."""
        left = g - self.own @ (self.own.swapaxes(-1, -2) @ g)
        output, taken, beside = self.v @ left, self.taken.swapaxes(-1, -2) @ left, self.shared * left
        square, whole = (left**2).sum(axis=-2), (g**2).sum(axis=-2)
        if together:
            square = square.sum(axis=1) + ((beside**2).sum(axis=1) - beside.sum(axis=1) ** 2).sum(axis=1)
            output, taken, whole = output.sum(axis=1), taken.sum(axis=1), whole.sum(axis=1)
        square = xp.maximum(square - (taken**2).sum(axis=-2), 0.0)
        return output / xp.sqrt(square + ABSORBED * whole + 1e-12)[..., None, :]


def moved(w: Weights, filters: Filters, design: Design, xp: ModuleType) -> Array:
    """(d, m, n, 2) outputs of kernels that stand at every row in turn, averaged over the places as evidence is."""
    d, m, R = design.present.shape
    g = w["kernel"][np.arange(R)[:, None] - np.arange(R) + ROWS].reshape(R, -1) * design.present[..., None]
    there = design.present[:, :, None, :, None]
    each = xp.where(there > 0, STEEP * xp.abs(filters(g, xp).reshape(d, m, -1, R, 2)), -1e6)
    return (log_sum(each, xp, axis=3)[..., 0, :] - xp.log(xp.maximum(there.sum(axis=3), 1.0))) / STEEP


def about(design: Design, xp: ModuleType) -> Array:
    """(d, m, 2 F + 1) the programme as a sensor sees it: means and mean squares of what is known, and the rows."""
    rows = design.present.sum(axis=2)[..., None]
    means = [(x * design.present[..., None]).sum(axis=2) / (rows + 1e-6) for x in (design.known, design.known**2)]
    return xp.concatenate([*means, rows / ROWS], axis=-1)


def head(w: Weights, name: str, seen: Array, context: Array, xp: ModuleType) -> Array:
    """Logits of what is seen in draws of a session of which something is known."""
    return mlp(w, name, bent(seen @ w[f"{name}-seen"] + context @ w[f"{name}-context"], xp), xp)


def mlp(w: Weights, name: str, x: Array, xp: ModuleType) -> Array:
    """Three layers."""
    for k in range(3):
        x = (bent(x, xp) if k else x) @ w[f"{name}{k}"] + w[f"{name}{k}b"]
    return x


def bent(x: Array, xp: ModuleType) -> Array:
    """x/(1 + e⁻ˣ)."""
    return 0.5 * x * (1 + xp.tanh(x / 2))


class Answer(NamedTuple):
    """The network's answer to a session."""

    log_odds: float
    """Log odds that something acts."""
    cause: str
    """The likeliest, if something does."""
    sensor: int | None = None
    """The likeliest, where the cause is of one sensor."""


def answer(file: Path, residuals: WhitenedResiduals) -> Answer:
    """The answer by weights as ``python -m benchmarks.study.neural`` writes them."""
    w, m = weights(file), residuals.baseline.residual.shape[1]
    z = residuals.z[: residuals.baseline.residual.size].reshape(-1, m).T
    found = log_posterior(w, Design(*(x[None] for x in design_of(residuals))), z[None, :, None])[0, 0]
    own, shared = np.split(found[1:], [m * len(w["own"])])
    each = np.array([*log_sum(own.reshape(m, -1), np, axis=0)[0], *shared])
    best, log_odds = int(np.argmax(each)), float(log_sum(found[1:], np)[0] - found[0])
    sensor = int(np.argmax(own.reshape(m, -1)[:, best])) if best < len(w["own"]) else None
    return Answer(log_odds, str([*w["own"], *w["shared"]][best]), sensor)


@lru_cache
def weights(file: Path) -> Weights:
    """The weights, with the names of the causes and the record of the training."""
    with np.load(file) as stored:
        return dict(stored)


def log_sum(x: Array, xp: ModuleType, axis: int = -1) -> Array:
    """ln Σ eˣ along an axis, which is kept."""
    top = x.max(axis=axis, keepdims=True)
    return top + xp.log(xp.exp(x - top).sum(axis=axis, keepdims=True))
