"""Agreement of model and readings in words. The words fit and unfit are kept for units."""

from dataclasses import dataclass, replace
from math import isfinite, pi, sqrt

import numpy as np

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.calibration.gross_slips import sentences
from estimator.message import joined, say, say_count
from estimator.moments import duration
from estimator.results import Calibration, Fit, ForceAnswer, KnownCombination
from service.kit.measures import COVERAGE, MINUS, Measure, decimals, measured, number, scale_measure, value_measure
from service.sessions.words.advice import too_few, what_to_add

UNLIKELY = 0.001
"""Probability of χ² below which the model does not explain the readings: the calibration's own bound."""
DOUBTFUL = 0.05
"""Probability of χ² below which the agreement is unusual: one sound session in twenty."""
TOO_GOOD = 0.999
"""Probability of χ² above which the noise must have been overstated."""
SMALLEST = 1e-4
"""Probability below which its size says no more."""


@dataclass(frozen=True)
class FitWords:
    """Agreement of model and readings, for people."""

    headline: str
    detail: str
    warnings: tuple[str, ...]


def fit_in_words(calibration: Calibration) -> FitWords:
    """The agreement by χ² and its probability, with warnings."""
    fit = calibration.fit
    headline = too_few(calibration) or _headline(fit)
    left_out = sentences(calibration.set_aside)
    return beside_screening(
        FitWords(headline, _detail(fit), (*left_out, *_warnings(fit), *_open(calibration))), calibration
    )


def beside_screening(words: FitWords, calibration: Calibration) -> FitWords:
    """The words with the findings in the raw rows of the readings put first."""
    return replace(words, warnings=(*(finding.message for finding in calibration.screening), *words.warnings))


def bands_in_words(calibration: Calibration, times: float | None) -> str:
    """Explanation of the bands beside residuals; ``times``: by how much the noise found is drawn wider, None where it
    is not.
    """
    if calibration.residuals.enlarged_by is None:
        return "The band is ±2σ of the noise that the calibration uses."
    stated = calibration.fit.noise == "stated"
    band = (
        "The band is ±2σ of the stated noise."
        if stated
        else "The file does not state all noise: the band is ±2σ of the noise estimated from the residuals."
    )
    if times is None:
        return band
    return say(
        "{band} The readings scatter more: the dashed lines are ±2σ of the noise that the calibration uses, up to "
        "{times} times larger.",
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
        return "The model agrees with the readings; the stated noise is probably too large."
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
                "All uncertainties were multiplied by {covariance_factor}: the stated noise does not explain the "
                "residuals. Look for structure in them.",
                covariance_factor=number(sqrt(fit.covariance_factor), 2),
            )
        )
    if not fit.converged:
        found.append(
            say(
                "The estimation did not converge within {iterations} iterations: do not use these numbers.",
                iterations=fit.iterations,
            )
        )
    return found


def _open(calibration: Calibration) -> list[str]:
    """The parameters that the session leaves open, with the remedy."""
    fit = calibration.fit
    if fit.rank >= fit.parameters:
        return []
    return [
        say(
            "The session determines {rank} of {parameters} parameters. Least certain: {weakest}; {calibration}.",
            rank=fit.rank,
            parameters=fit.parameters,
            weakest=fit.weakest[0],
            calibration=what_to_add(calibration),
        )
    ]


READING_TERMS = {
    "zero_reading": ("K·b", 0),
    "sensitivity_x": ("K·e_x", 1),
    "sensitivity_y": ("K·e_y", 1),
    "sensitivity_z": ("K·e_z", 1),
    "quadratic_reading": ("K·c", 2),
}
"""Terms that readings are linear in: symbol, and the power of the input that it multiplies."""
NEGLIGIBLE = 1e-6
"""Share of the largest term below which a term is not written: six decimals show nothing of it."""


@dataclass(frozen=True)
class _Term:
    """One quantity of a sum, with its coefficient and people's measure."""

    name: str
    measure: Measure
    coefficient: float


def combination_in_words(known: KnownCombination, kind: str) -> str:
    """``bias + 0.5 × quadratic = 12.3 ± 0.4 µg``; readings in their own unit, per g (per °/s) and its square."""
    terms = [_known_term(name, coefficient, kind) for name, coefficient in known.coefficients.items()]
    lead = max(terms, key=lambda t: abs(t.coefficient))
    shares = [(t.coefficient / lead.coefficient, t.name) for t in terms]
    first, *others = [(share, name) for share, name in shares if abs(share) > NEGLIGIBLE]
    rest = joined(
        "",
        (
            say(" {sign} {product}", sign=MINUS if share < 0 else "+", product=_product(abs(share), name))
            for share, name in others
        ),
    )
    expanded = None if known.sigma is None else COVERAGE * known.sigma
    total = measured(known.value, expanded, Measure(lead.measure.label, 1 / lead.coefficient)).rstrip()
    sign, product = MINUS if first[0] < 0 else "", _product(abs(first[0]), first[1])
    return say("{sign}{product}{rest} = {total}", sign=sign, product=product, rest=rest, total=total)


FORCE = STANDARD_GRAVITY * 3600 * 180 / pi
"""(°/h)/g in one (rad/s)/(m/s²)."""


def answer_in_words(answer: ForceAnswer, k: float) -> str:
    """``(120 ± 9, −3 ± 9, 14 ± 9) (°/h)/g``: a gyro's answer to specific force along the block's axes, ± U."""
    expanded = k * FORCE * np.sqrt(np.diagonal(answer.covariance))
    digits = decimals(float(expanded.max()))
    parts = (
        say("{value} ± {expanded}", value=number(float(value), digits), expanded=number(float(spread), digits))
        for value, spread in zip(FORCE * answer.value, expanded, strict=True)
    )
    return say("({values}) (°/h)/g", values=joined(", ", parts))


def _known_term(name: str, coefficient: float, kind: str) -> _Term:
    element = name.rpartition(".")[2]
    if element in READING_TERMS:
        written, power = READING_TERMS[element]
        measure = Measure("", scale_measure(kind).factor ** power)
        return _Term(written, measure, coefficient / measure.factor)
    measure = value_measure(kind, element.partition("_")[0], 0.0)
    return _Term(element, measure, coefficient / measure.factor)


def _product(share: float, name: str) -> str:
    """``0.5 × quadratic``, the share above zero."""
    if share == 1:
        return name
    return say("{share} × {name}", share=f"{share:.6f}".rstrip("0").rstrip("."), name=name)


def switched_on(begun: float | None) -> str:
    """``40 min before the first reading``, from seconds; empty where the file does not say."""
    return "" if begun is None else say("{begun} before the first reading", begun=duration(begun))
