"""How model and readings agree, in words. What fits or does not is a unit, so no other thing is said to."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, sqrt

from estimator.health.common_motion import AXES, SEPARATED, UNCLEAR, CommonMotion
from estimator.message import joined, say, say_count
from estimator.results import Calibration, Fit, KnownCombination
from estimator.wording import few
from service.kit.measures import (
    COARSE_MEASURES,
    COVERAGE,
    DEGREE,
    MINUS,
    Measure,
    deviation_measure,
    measured,
    number,
    scale_measure,
    signed,
    value_measure,
)
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


READING_TERMS = {
    "zero_reading": ("K·b", 0),
    "sensitivity_x": ("K·e_x", 1),
    "sensitivity_y": ("K·e_y", 1),
    "sensitivity_z": ("K·e_z", 1),
    "quadratic_reading": ("K·c", 2),
}
"""What readings are linear in: how it is written, and the power of the input that it multiplies."""
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


SIGNIFICANT = 0.01
"""Chance of saying so of a block that did not move."""
JUDGED = "The sensors are judged without it."
NEARLY = 0.94
"""Cosine of 20°: a turn this near to an axis of the block is named after it."""


@dataclass(frozen=True)
class MotionLine:
    """One sentence, and whether it asks for attention."""

    tone: str
    text: str


def motions_in_words(
    motions: Sequence[CommonMotion], coverage: float, since: str = "since the reference"
) -> tuple[MotionLine, ...]:
    """One sentence for each quantity that there is something to say of."""
    several = len({motion.kind for motion in motions}) > 1
    of = {motion.kind: say(" of the {kind}s", kind=motion.kind) if several else "" for motion in motions}
    lines = [_line(motion, coverage, of[motion.kind], since) for motion in motions]
    return tuple(line for line in lines if line is not None)


def is_significant(motion: CommonMotion) -> bool:
    """Whether the block moved as a whole, beyond what noise does once in a hundred sessions."""
    return motion.state == SEPARATED and motion.p_value is not None and motion.p_value < SIGNIFICANT


def _line(motion: CommonMotion, coverage: float, whose: str, since: str) -> MotionLine | None:
    if motion.state != SEPARATED:
        return MotionLine("none", _undivided(motion, whose))
    if is_significant(motion):
        return MotionLine("undecidable", joined("", (_together(motion, coverage, whose, since), _alone(motion))))
    return None


def _together(motion: CommonMotion, coverage: float, whose: str, since: str) -> str:
    if motion.quantity == AXES:
        size = measured(motion.size, coverage * motion.sigma, _turn_measure(motion))
        return say(
            "The whole block{whose} turned by {size} about {motion} {since}: it sits "
            "otherwise, or the stand has turned. {judged}",
            whose=whose,
            size=size,
            motion=_about(motion),
            since=since,
            judged=JUDGED,
        )
    size = signed(motion.size, coverage * motion.sigma, deviation_measure(motion.kind, "scale", motion.size))
    cause = "gravity or the stand's elevation" if motion.kind == "accelerometer" else "the stand or its clock"
    return say(
        "All scale factors{whose} changed together by {size} {since}: that is of {cause}. {judged}",
        whose=whose,
        size=size,
        since=since,
        cause=cause,
        judged=JUDGED,
    )


def _turn_measure(motion: CommonMotion) -> Measure:
    """Of a block that was mounted otherwise, degrees."""
    if motion.size >= DEGREE:
        return COARSE_MEASURES[motion.kind, "axis"]
    return deviation_measure(motion.kind, "axis", motion.size)


def _about(motion: CommonMotion) -> str:
    """The block's axis that the turn is about, or the direction."""
    direction = [component / motion.size for component in motion.value]
    largest = max(range(3), key=lambda i: abs(direction[i]))
    if abs(direction[largest]) > NEARLY:
        return f"{'−' if direction[largest] < 0 else ''}{'XYZ'[largest]}"
    return "(" + ", ".join(number(component, 2) for component in direction) + ")"


def _alone(motion: CommonMotion) -> str:
    """Who did not move with the others."""
    if not motion.left_out:
        return ""
    what = "input axis" if motion.quantity == AXES else "scale factor"
    *others, last = motion.left_out
    if not others:
        return say(" Beside that, the {what} of {last} moved on its own.", what=what, last=last)
    several = "input axes" if motion.quantity == AXES else "scale factors"
    return say(
        " Beside that, the {several} of {others} and {last} moved on their own.",
        several=several,
        others=joined(", ", others),
        last=last,
    )


def _undivided(motion: CommonMotion, whose: str) -> str:
    turn = (
        say("a turn of the whole block{whose}", whose=whose)
        if motion.quantity == AXES
        else say("a change of all scale factors{whose}", whose=whose)
    )
    one = "a change of one sensor"
    judged = "every sensor is judged on its whole change"
    if motion.state == UNCLEAR:
        return say(
            "The sensors do not agree on {turn}, and it cannot be told which of them moved: {judged}.",
            turn=turn,
            judged=judged,
        )
    return say(
        "{sensors} to tell {turn} from {one}: {judged}.",
        sensors=few(len(motion.sensors), "sensor"),
        turn=turn,
        one=one,
        judged=judged,
    )
