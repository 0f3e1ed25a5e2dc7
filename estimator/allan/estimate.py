"""Estimates the noise terms of every sensor from rests, with the Allan curve that they were read from."""

import numpy as np

from estimator.allan.fit import AllanFit, fit
from estimator.allan.model import AllanModel, model_of
from estimator.allan.rests import Rests
from estimator.allan.results import TERMS, AllanTerm, BlockNoise, SensorNoise
from estimator.allan.variance import Variances, variances
from estimator.session import Array, Sensor


def allan_terms(rests: Rests) -> BlockNoise | None:
    """The noise of every sensor, in order; None where no rest is long enough for a single τ, eight samples.

    Nothing is decided of a sensor whose readings never change: its converter is coarser than its noise.
    """
    seen = variances(rests.readings, rests.interval)
    if seen is None:
        return None
    model = model_of(seen)
    sensors = tuple(_noise(sensor, seen, model, k) for k, sensor in enumerate(rests.sensors))
    return BlockNoise(len(rests.readings), rests.longest, rests.lasted, sensors)


def _noise(sensor: Sensor, seen: Variances, model: AllanModel, k: int) -> SensorNoise:
    value = seen.value[:, k]
    fitted = fit(model, value) if np.all(value > 0) else None
    squares = np.array([0.0, value[0] * seen.tau[0], 0.0, 0.0]) if fitted is None else fitted.square
    expected = model.shapes @ squares
    scatter = np.diag(model.covariance(squares))
    freedom = 2 * expected**2 / np.where(scatter > 0, scatter, np.inf)
    run = None if fitted is None else (float(seen.tau[fitted.first]), float(seen.tau[fitted.end - 1]))
    terms = tuple(AllanTerm(name, None, None, None) for name in TERMS) if fitted is None else _terms(fitted)
    return SensorNoise(sensor.name, sensor.kind, terms, seen.tau, np.sqrt(value), freedom, run)


def _terms(fitted: AllanFit) -> tuple[AllanTerm, ...]:
    return tuple(
        _term(name, *row)
        for name, *row in zip(TERMS, fitted.square, fitted.sigma, fitted.decided, fitted.most, strict=True)
    )


def _term(name: str, square: Array, sigma: Array, decided: Array, most: Array) -> AllanTerm:
    if not decided:
        return AllanTerm(name, None, None, float(most))
    value = float(np.sqrt(square))
    return AllanTerm(name, value, float(sigma) / (2 * value), None)
