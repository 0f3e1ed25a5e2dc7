"""Empirical terms: what sessions share and no catalogue has, learned from some of them and confirmed on the others.

Theory
------
Forward selection on the pooled score: the term with the largest gain, all amplitudes refitted. The e-value over the
whole library, the mean of its terms' (as of causes), must reach 1/α for every term that is taken. Then each is tried
without: one that the others make needless is dropped. A term is shown where the sessions that took no part are
predicted better with the amplitudes of the others (`JointFit.predicts`). It describes; it names no physical cause.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from estimator.calibration.calibrate import averaged
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.flipped_run import with_its_flip
from estimator.diagnosis.residuals.whitened import INVISIBLE, WhitenedResiduals
from estimator.groups.candidates import columns_of
from estimator.groups.evidence import ALPHA, log_bayes, log_sum
from estimator.groups.joint_fit import JointFit
from estimator.groups.library import library
from estimator.groups.pictures import Pictured, drawn, left_without, pooled_picture
from estimator.groups.results import EmpiricalTerm, Picture
from estimator.groups.statistics import HARMONIC
from estimator.least_squares import given as conditional
from estimator.least_squares import inverse, orthonormal
from estimator.message import joined
from estimator.session import Array, CalibrationSession

HELD_OUT = 3
"""Every third session takes no part in the fit: enough are left to fit, and both parts reach over the group's life."""

FEWEST = 4
"""Sessions from which on there is something to fit and to confirm."""

MOST = 4
"""Terms of one place; what needs more is no simple law."""

Key = tuple[str, ...]
"""The words of a term: the same term in every session."""


@dataclass(frozen=True, eq=False)
class Library:
    """All terms of one place in one session. N rows, D columns."""

    residuals: WhitenedResiduals
    keys: tuple[tuple[Key, str, str], ...]
    """Words, unit and variable of every term."""
    starts: Array
    """(K + 1,) int"""
    columns: Array
    """(R, m, D) m/s² (rad/s) per unit amplitude."""
    trace: Array
    """(N, D) standard errors per unit amplitude."""
    z: Array
    """(N,) standard errors, what is named taken out."""

    @classmethod
    def of(cls, baseline: Baseline, sensor: str, named: Sequence[tuple[str, str, float | None]]) -> "Library":
        """The library at a place, by its sensor's name; ``named`` causes (cause, sensor, shape) are left free."""
        residuals, terms = WhitenedResiduals.of(baseline), library(baseline, sensor)
        columns = np.concatenate([t.columns for t in terms], axis=-1)
        raw, trace = np.linalg.norm(residuals.whitened(columns), axis=0), residuals.trace(columns)
        trace = trace * (np.linalg.norm(trace, axis=0) > INVISIBLE * np.maximum(raw, 1e-300))
        z = residuals.z
        for b, c in columns_of(baseline) if named else ():
            if (b.cause, b.sensor, b.shape) in named:
                basis = orthonormal(residuals.trace(c), 1e-3)
                z, trace = z - basis @ (basis.T @ z), trace - basis @ (basis.T @ trace)
        starts = np.concatenate([[0], np.cumsum([len(t.words) for t in terms])]).astype(int)
        return cls(residuals, tuple((t.words, t.unit, t.variable) for t in terms), starts, columns, trace, z)

    def at(self, key: Key) -> Array | None:
        """(w,) columns of a term; None where the session lacks it."""
        for k, (words, _, _) in enumerate(self.keys):
            if words == key:
                return np.arange(self.starts[k], self.starts[k + 1])
        return None


@dataclass(frozen=True, eq=False)
class Learned:
    """Terms of one place with the fit of their a amplitudes."""

    sensor: str
    keys: tuple[Key, ...]
    fit: JointFit

    @property
    def value(self) -> Array:
        """(a,) SI."""
        return self.fit.amplitude

    @property
    def covariance(self) -> Array:
        """(a, a) SI²."""
        return self.fit.covariance

    def predicted(self, session_terms: Library) -> Array:
        """(R, m) m/s² (rad/s): what the terms add in a session."""
        found = np.zeros(session_terms.columns.shape[:2])
        start = 0
        for key in self.keys:
            columns = session_terms.at(key)
            if columns is not None:
                found = found + session_terms.columns[..., columns] @ self.value[start : start + len(key)]
            start += len(key)
        return found


def libraries(sessions: Sequence[CalibrationSession], sensor: str) -> list[Library]:
    """The library of one place in every session, no cause named."""
    return [Library.of(with_its_flip(averaged(s)), sensor, ()) for s in sessions]


def learn(sensor: str, whole: Sequence[Library]) -> Learned | None:
    """The terms of a place; None where nothing is sure enough, or nothing holds in the sessions left out."""
    if len(whole) < FEWEST:
        return None
    fit = [x for k, x in enumerate(whole) if k % HELD_OUT != HELD_OUT - 1]
    held = [x for k, x in enumerate(whole) if k % HELD_OUT == HELD_OUT - 1]
    every = tuple(dict.fromkeys(key for x in fit for key, _, _ in x.keys))
    chosen: tuple[Key, ...] = ()
    while len(chosen) < MOST:
        best = strongest(fit, every, chosen)
        if best is None:
            break
        chosen = (*chosen, best)
    for key in chosen:
        others = tuple(k for k in chosen if k != key)
        if evidence(fit, (key,), others)[0] - np.log(len(every)) < -np.log(ALPHA):
            chosen = others
    chosen = confirmed(sensor, fit, held, chosen)
    return fitted(sensor, fit, chosen) if chosen else None


def confirmed(sensor: str, fit: Sequence[Library], held: Sequence[Library], chosen: tuple[Key, ...]) -> tuple[Key, ...]:
    """The terms without those that the sessions left out do better without; none where these gain nothing by the rest.

    Whenever one goes the others are asked again: what one gained beside another it may lose alone.
    """
    while chosen:
        fewer = [tuple(k for k in chosen if k != key) for key in chosen]
        gains = [gain(fitted(sensor, fit, keys), held) if keys else 0.0 for keys in fewer]
        best = int(np.argmax(gains))
        if gain(fitted(sensor, fit, chosen), held) > gains[best]:
            break
        chosen = fewer[best]
    return chosen if chosen and gain(fitted(sensor, fit, chosen), held) > 0 else ()


def joint_fit(whole: Sequence[Library], keys: Sequence[Key]) -> JointFit:
    """Some terms fitted together to all sessions."""
    widths = [len(k) for k in keys]
    U, F = np.zeros((len(whole), sum(widths))), np.zeros((len(whole), sum(widths), sum(widths)))
    for n, session_terms in enumerate(whole):
        places: list[int] = []
        taken: list[int] = []
        start = 0
        for key, width in zip(keys, widths, strict=True):
            columns = session_terms.at(key)
            if columns is not None:
                places += range(start, start + width)
                taken += columns.tolist()
            start += width
        x = session_terms.trace[:, taken]
        U[n, places], F[n][np.ix_(places, places)] = x.T @ session_terms.z, x.T @ x
    return JointFit(U, F)


def evidence(whole: Sequence[Library], keys: Sequence[Key], given: Sequence[Key]) -> Array:
    """(K,) ln Bayes factor of each of K terms given others, in the pool."""
    found = []
    known = sum(len(k) for k in given)
    for key in keys:
        fit = joint_fit(whole, [*given, key])
        first = fit.F[np.argmax(fit.F[:, known:, known:].sum(axis=(1, 2)) > 0)][known:, known:]
        score, left = conditional(fit.U.sum(axis=0), fit.F.sum(axis=0), range(known), 1e-3)
        found.append(log_bayes(score[None, known:], left[None, known:, known:], first[None])[0])
    return np.array(found)


def strongest(whole: Sequence[Library], every: Sequence[Key], chosen: tuple[Key, ...]) -> Key | None:
    """The term with the largest evidence given those chosen; None where the library's e-value is below 1/α."""
    rest = [k for k in every if k not in chosen]
    values = evidence(whole, rest, chosen)
    if log_sum(values) - np.log(len(every)) < -np.log(ALPHA):
        return None
    return rest[int(np.argmax(values))]


def fitted(sensor: str, whole: Sequence[Library], keys: tuple[Key, ...]) -> Learned:
    """The amplitudes of some terms in the pool of sessions."""
    return Learned(sensor, keys, joint_fit(whole, keys))


def gain(terms: Learned, held: Sequence[Library]) -> float:
    """Log predictive density of the sessions left out that the terms gain."""
    return terms.fit.predicts(joint_fit(held, terms.keys))


def shown(subject: str, terms: Learned, whole: Sequence[Library]) -> EmpiricalTerm:
    """The learned terms of a place as people see them."""
    held = [x for k, x in enumerate(whole) if k % HELD_OUT == HELD_OUT - 1]
    known = {words: (unit, variable) for x in whole for words, unit, variable in x.keys}
    units = tuple(known[key][0] for key in terms.keys for _ in key)
    removed = terms.fit.reduces(joint_fit(held, terms.keys))
    excess = float(sum(x.z @ x.z - x.residuals.freedom for x in held))
    nearest, apart = nearest_cause(terms, whole)
    return EmpiricalTerm(
        equation=equation(terms, units),
        words=tuple(w for key in terms.keys for w in key),
        sensors=(terms.sensor,) if terms.sensor else (),
        subject=subject,
        amplitude=tuple(terms.value.tolist()),
        sigma=tuple(np.sqrt(np.diagonal(terms.covariance)).tolist()),
        units=units,
        gain=gain(terms, held),
        explained=float(np.clip(removed / excess, 0.0, 1.0)) if excess > 0 else 0.0,
        nearest=nearest,
        separation=apart,
        picture=picture(terms, whole, known[terms.keys[0]][1]),
    )


def equation(terms: Learned, units: Sequence[str]) -> str:
    """``δ = (1.2e-6 ± 1e-7) m/s²·sin 3β + …``."""
    words = [w for key in terms.keys for w in key]
    sigma = np.sqrt(np.diagonal(terms.covariance))
    parts = [f"({v:.3g} ± {s:.1g}) {u}·{w}" for v, s, u, w in zip(terms.value, sigma, units, words, strict=True)]
    return joined(" + ", parts)


def nearest_cause(terms: Learned, whole: Sequence[Library]) -> tuple[str, float]:
    """The catalogue cause at the same place that comes nearest, and how far it stays, standard errors on the pool."""
    total = 0.0
    sums: dict[tuple[str, float | None], tuple[Array, Array]] = {}
    for x in whole:
        baseline = x.residuals.baseline
        truth = x.residuals.trace(terms.predicted(x)[..., None])[:, 0]
        total += float(truth @ truth)
        for b, c in columns_of(baseline):
            if b.cause != HARMONIC and b.sensor in ("", terms.sensor):
                trace = x.residuals.trace(c)
                trace = trace * (
                    np.linalg.norm(trace, axis=0) > INVISIBLE * np.linalg.norm(x.residuals.whitened(c), axis=0)
                )
                U, F = sums.get((b.cause, b.shape), (np.zeros(b.width), np.zeros((b.width, b.width))))
                sums[b.cause, b.shape] = (U + trace.T @ truth, F + trace.T @ trace)
    left = {key: total - float(U @ inverse(F) @ U) for key, (U, F) in sums.items()}
    if not left:
        return "", float(np.sqrt(total))
    cause, _ = best = min(left, key=lambda key: left[key])
    return cause, float(np.sqrt(max(left[best], 0.0)))


def picture(terms: Learned, whole: Sequence[Library], variable: str) -> Picture:
    """Pooled residual of the place against a variable, before and after."""
    parts: list[Pictured] = []
    subject = terms.sensor or terms.keys[0][0].partition(":")[0]
    for session_terms in whole:
        left = left_without(session_terms.residuals, terms.predicted(session_terms))
        parts += list(drawn(session_terms.residuals.baseline, left, subject, variable))
    return pooled_picture(parts, variable, subject)
