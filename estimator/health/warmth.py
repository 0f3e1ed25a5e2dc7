"""The dependence of a parameter on the temperature of its sessions: a line or a parabola.

b·(T − T̄), or b·(T − T̄) + c·(T − T̄)², fitted at the walk q that makes the law and the readings together most likely.
A parabola is taken where c explains what the line leaves, as chance rarely does (χ² of as many numbers as c has). A law
is found where chance rarely explains as much as it does, and where no change through time explains more; a parabola
has a number more to explain with, which costs the logarithm of the sessions (Schwarz 1978).
"""

from dataclasses import dataclass, replace

import numpy as np

from estimator.health.fits import Readings, fits
from estimator.health.shapes import Shapes
from estimator.session import Array
from estimator.significance import p_value

WARMED = 1.5
"""°C, standard deviation of the sessions' temperatures from which on a coefficient is looked for: below it the
laboratory was kept at its set point."""
ENOUGH = 5
"""Sessions with a temperature, at least: level, coefficient and two numbers that speak against it."""
ENOUGH_TO_BEND = 6
"""Sessions with a temperature, at least, for a parabola, which has a number more."""
BENT = 1 / 3
"""Part of the level at which a parabola is taken in place of a line: both together are found by chance as rarely as is
said."""
FLAT = 1e-6
"""Part of a column that must be left beside level and line for it to show: temperatures at two values bend nothing."""


@dataclass(frozen=True, eq=False)
class Warmth:
    """The dependence of a parameter on the temperature of the session."""

    mean: float
    """°C of the sessions, T̄."""
    size: Array
    """(q, k) b, T per °C, and c of a parabola, T per °C²."""
    covariance: Array
    """(k, q, q) covariance of each component's coefficients, T per °C and T per °C², squared."""
    p_value: float
    is_found: bool

    @property
    def coefficient(self) -> Array:
        """(k,) T per °C, at the mean temperature."""
        return np.asarray(self.size[0])

    @property
    def sigma(self) -> Array:
        """(k,) one sigma of the coefficient, T per °C."""
        return np.sqrt(self.covariance[:, 0, 0])

    @property
    def is_bent(self) -> bool:
        """Whether the law is a parabola."""
        return len(self.size) > 1

    def between(self, start: float, stop: float) -> tuple[Array, Array]:
        """(k,) T, what going from one temperature to another, °C, is worth, and (k,) one sigma of it."""
        bent = (stop - self.mean) ** 2 - (start - self.mean) ** 2
        step = np.array([stop - start, bent])[: len(self.size)]
        return step @ self.size, np.sqrt(np.einsum("q,kqp,p->k", step, self.covariance, step))

    def swing(self, temperature: Array) -> float:
        """T, the farthest that it takes the level at the mean temperature over a span of temperatures (n,), °C."""
        known = temperature[np.isfinite(temperature)]
        return max(float(np.linalg.norm(self.between(self.mean, at)[0])) for at in known)


def shows_temperature(temperature: Array) -> bool:
    """Whether sessions at these temperatures (n,), °C, NaN where unknown, can determine a coefficient."""
    known = np.isfinite(temperature)
    return bool(known.sum() >= ENOUGH and temperature[known].std() >= WARMED)


def centred(temperature: Array) -> Array:
    """(n,) °C about their mean; a session without one has the mean, as the likeliest."""
    known = np.isfinite(temperature)
    return np.where(known, temperature - temperature[known].mean(), 0.0) if known.any() else np.zeros(len(known))


def with_temperature(readings: Readings, temperature: Array, warmth: Warmth) -> Readings:
    """The readings with the law as a regressor of any size; the forecast level is that at the mean temperature."""
    columns = _columns(temperature)[:, : len(warmth.size)]
    base = np.concatenate([readings.base, columns], axis=1)
    return replace(readings, base=base, now=np.append(readings.now, np.zeros(columns.shape[1])))


def warmth_of(readings: Readings, temperature: Array, rival: Array | None, level: float) -> Warmth | None:
    """The law of one parameter, where these sessions can tell of one.

    Parameters
    ----------
    temperature : (n,) °C of each session; NaN where it is not known.
    rival : (n,) the course through time that it must explain more than, any unit; None where there is none.
    level : chance of a law where there is none.
    """
    if not shows_temperature(temperature):
        return None
    columns, components = _columns(temperature), readings.value.shape[1]
    line, bent = (_fitted(readings, columns[:, :q]) for q in (1, 2))
    gained = p_value(2 * (bent.log_likelihood - line.log_likelihood), components)
    is_bent = _can_bend(temperature) and gained < BENT * level
    chosen, q = (bent, 2) if is_bent else (line, 1)
    p = float(p_value(chosen.explained, q * components))
    price = (q - 1) * components * np.log(len(temperature))
    explains = rival is None or _explained(readings, columns[:, :q]) - price >= _explained(readings, rival[:, None])
    return Warmth(_mean(temperature), chosen.size, chosen.covariance, p, bool(p < level and explains))


def chance_of(readings: Readings, temperature: Array) -> float:
    """Chance of readings of one component following the temperature (n,), °C, so well where they do not, by a line and,
    where the sessions show one, a bend."""
    columns = shown_columns(temperature)
    return float(p_value(_fitted(readings, columns).explained, columns.shape[1]))


@dataclass(frozen=True, eq=False)
class _Fitted:
    """Some columns acting, at the walk that suits them best."""

    size: Array
    """(q, k) T per unit of each column."""
    covariance: Array
    """(k, q, q)"""
    explained: float
    """χ² of the columns against none of them."""
    log_likelihood: float
    """Log likelihood with the columns, up to a constant."""


def _fitted(readings: Readings, columns: Array) -> _Fitted:
    """Fits columns (n, q), of any unit."""
    found = fits(readings, together(columns))
    information = np.swapaxes(found.shapes, -1, -2) @ found.shapes
    covariance = np.linalg.pinv(information, hermitian=True)
    size = (covariance @ found.score[..., None])[..., 0]
    explained = (found.score * size).sum(axis=-1)
    logs = (found.log_likelihood + explained / 2).sum(axis=1)
    best = int(np.argmax(logs))
    return _Fitted(size[best].T, covariance[best], float(explained[best].sum()), float(logs[best]))


def _explained(readings: Readings, columns: Array) -> float:
    """χ² of columns (n, q) against noise alone."""
    found = fits(readings, together(columns), np.zeros(1))
    information = np.swapaxes(found.shapes, -1, -2) @ found.shapes
    size = np.linalg.pinv(information, hermitian=True) @ found.score[..., None]
    return float((found.score * size[..., 0]).sum())


def together(columns: Array) -> Shapes:
    """Columns (n, q) of any unit, for a fit of their sizes."""
    q = columns.shape[1]
    return Shapes(columns, np.zeros(q, int), np.zeros(q, int), np.ones(q), np.ones(q))


def _mean(temperature: Array) -> float:
    return float(temperature[np.isfinite(temperature)].mean())


def _columns(temperature: Array) -> Array:
    """(n, 2) °C about their mean and its square, °C²; a session without one is usual."""
    warm, known = centred(temperature), np.isfinite(temperature)
    return np.stack([warm, np.where(known, warm**2, (warm[known] ** 2).mean())], axis=1)


def shown_columns(temperature: Array) -> Array:
    """(n, q) those of `_columns` that sessions at (n,) °C determine: both where they can bend, else the line."""
    return _columns(temperature)[:, : 2 if _can_bend(temperature) else 1]


def _can_bend(temperature: Array) -> bool:
    """Whether the sessions show a parabola apart from level and line."""
    known = temperature[np.isfinite(temperature)]
    if len(known) < ENOUGH_TO_BEND:
        return False
    warm = known - known.mean()
    beside = np.stack([np.ones(len(warm)), warm], axis=1)
    left = warm**2 - beside @ np.linalg.lstsq(beside, warm**2)[0]
    return bool((left @ left) > FLAT * (warm**4).sum())
