"""How model and readings agree, in words. What fits or does not is a unit, so no other thing is said to."""

from dataclasses import dataclass
from math import isfinite, sqrt

from estimator.message import say, say_count
from estimator.results import Calibration, Fit
from service.kit.measures import number
from service.sessions.words.advice import too_few, what_to_add

UNLIKELY = 0.001
"""Probability of χ² below which the model does not explain the readings: the calibration's own bound."""
DOUBTFUL = 0.05
"""Probability of χ² below which the agreement is unusual: one sound session in twenty."""
TOO_GOOD = 0.999
"""Probability of χ² above which the noise must have been overstated."""
SMALLEST = 1e-4
"""Probability below which its size tells nobody more."""


@dataclass(frozen=True)
class FitWords:
    """How model and readings agree, for people."""

    headline: str
    detail: str
    warnings: tuple[str, ...]


def fit_in_words(calibration: Calibration) -> FitWords:
    """What χ² and its probability say, and what to be careful of."""
    fit = calibration.fit
    headline = too_few(calibration) or _headline(fit)
    return FitWords(headline, _detail(fit), (*_warnings(fit), *_open(calibration)))


def bands_in_words(calibration: Calibration, times: float | None) -> str:
    """What the bands beside residuals are; ``times``: how much wider the noise found is drawn, None where it is not."""
    if calibration.residuals.enlarged_by is None:
        return "The band is ±2σ of the noise that the calibration reckons with."
    stated = calibration.fit.noise == "stated"
    band = (
        "The band is ±2σ of the stated noise."
        if stated
        else "The file does not state all noise: the band is ±2σ of what was estimated from the residuals."
    )
    if times is None:
        return band
    return say(
        "{band} The readings scatter more than that: the dashed lines are ±2σ of the noise that "
        "the calibration reckons with instead, up to {times} times as much.",
        band=band,
        times=number(times, 1),
    )


def _headline(fit: Fit) -> str:
    if fit.p_value is None:
        return "The file states no standard errors: the noise was estimated from the residuals."
    if fit.p_value < UNLIKELY:
        return "The readings scatter more than the stated noise allows."
    if fit.p_value < DOUBTFUL:
        return "The model agrees with the readings, but the residuals are larger than usual."
    if fit.p_value > TOO_GOOD:
        return "The model agrees with the readings; the stated noise looks too large."
    return "The model explains the readings within the stated noise."


def _detail(fit: Fit) -> str:
    chance = ""
    if fit.p_value is not None:
        percent = "less than 0.01" if fit.p_value < SMALLEST else number(100 * fit.p_value, 1 + (fit.p_value < 0.01))
        chance = say("; a sound model would give this much or more in {percent} % of sessions", percent=percent)
    return say_count(
        "χ² = {chi2} for {n} degree of freedom{chance}.",
        "χ² = {chi2} for {n} degrees of freedom{chance}.",
        fit.dof,
        chi2=number(fit.chi2, 1),
        chance=chance,
    )


def _warnings(fit: Fit) -> list[str]:
    found: list[str] = []
    if fit.covariance_factor > 1 and isfinite(fit.covariance_factor):
        found.append(
            say(
                "All uncertainties were enlarged {covariance_factor} times, because the stated noise "
                "cannot explain the residuals. Look for structure in them.",
                covariance_factor=number(sqrt(fit.covariance_factor), 2),
            )
        )
    if not fit.converged:
        found.append(
            say(
                "The estimation did not settle within {iterations} iterations: do not rely on these numbers.",
                iterations=fit.iterations,
            )
        )
    return found


def _open(calibration: Calibration) -> list[str]:
    """What the session leaves open, and what to add."""
    fit = calibration.fit
    if fit.rank >= fit.parameters:
        return []
    return [
        say(
            "The session determines {rank} of {parameters} parameters. The least known is {weakest}; {calibration}.",
            rank=fit.rank,
            parameters=fit.parameters,
            weakest=fit.weakest[0],
            calibration=what_to_add(calibration),
        )
    ]
