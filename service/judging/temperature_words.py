"""Effect of temperature on a verdict, in words."""

from collections.abc import Iterator, Sequence

import numpy as np

from estimator.diagnosis.explanation.temperature import LEAST_DIFFERENCE
from estimator.health.temperature_law import TemperatureCorrection
from estimator.message import capitalised, joined, say
from estimator.results import Residuals
from estimator.session import Array
from estimator.wording import counted
from service.judging.covered import CoveredTemperatures, covered
from service.kit.measures import HARD, PARAMETER_NAMES, THIN, decimals, deviation_measure, in_measure, measured, number
from service.sessions.decision import Decision


def law_in_words(decision: Decision, step: TemperatureCorrection) -> str:
    """``A2 bias: change of 84 µg measured at 35 °C, 31 ± 9 µg at 20 °C by the law of 7 sessions.``"""
    as_measured, corrected = _changes(decision, step)
    return say(
        "{sensor} {parameter}: change of {measured} measured at {temperature}, {corrected} at {reference} by the law "
        "of {learned}.",
        sensor=decision.sensor,
        parameter=PARAMETER_NAMES[decision.parameter],
        measured=as_measured,
        temperature=in_degrees(step.temperature),
        corrected=corrected,
        reference=in_degrees(step.reference_temperature),
        learned=_learned(step),
    )


def _learned(step: TemperatureCorrection) -> str:
    """``7 sessions``, or with units of the type."""
    sessions = counted(step.sessions, "session")
    if not step.units:
        return sessions
    return say("{sessions} and {units} of its type", sessions=sessions, units=counted(step.units, "unit"))


def laws_in_words(decisions: tuple[Decision, ...]) -> tuple[str, ...]:
    """One sentence on the corrections for temperature in a session, the largest first; none where there were none."""
    taken = [(decision, step) for decision in decisions if (step := decision.temperature_correction) is not None]
    taken.sort(key=lambda pair: -abs(pair[1].worth) / pair[0].tolerance)
    if not taken:
        return ()
    step = max((law for _, law in taken), key=lambda law: (law.units, law.sessions))
    sentence = say(
        "Measured at {temperature} and judged at {reference}, by the law of {learned}: {changes}.",
        temperature=in_degrees(step.temperature),
        reference=in_degrees(step.reference_temperature),
        learned=_learned(step),
        changes=joined("; ", (*(_short(*pair) for pair in taken[:MOST_SAID]), *_rest(taken[MOST_SAID:]))),
    )
    return (sentence,)


def _rest(taken: Sequence[object]) -> Iterator[str]:
    if taken:
        yield say("{rest} more", rest=len(taken))


def _short(decision: Decision, step: TemperatureCorrection) -> str:
    """``A2 bias 84 µg → 31 ± 9 µg``."""
    as_measured, corrected = _changes(decision, step)
    name = PARAMETER_NAMES[decision.parameter]
    parts = {"sensor": decision.sensor, "parameter": name, "measured": as_measured, "corrected": corrected}
    return say("{sensor} {parameter} {measured} → {corrected}", **parts)


def _changes(decision: Decision, step: TemperatureCorrection) -> tuple[str, str]:
    """``84 µg``, as measured, and ``31 ± 9 µg``, at the reference's temperature."""
    largest = max(abs(step.measured), abs(step.corrected), decision.tolerance)
    measure = deviation_measure(decision.kind, decision.parameter, largest)
    digits = decimals(in_measure(step.expanded, measure))
    as_measured = number(in_measure(step.measured, measure), digits) + THIN + measure.label
    return as_measured, measured(step.corrected, step.expanded, measure)


def elsewhere(outside: float, now: float, known: tuple[float, float], worth: str) -> str:
    """``it was measured at 35 °C, 13 °C above its reference and earlier sessions (19–22 °C)``, and what that means."""
    parts = {"temperature": in_degrees(now), "difference": in_degrees(abs(outside)), "earlier": _between(*known)}
    above = "it was measured at {temperature}, {difference} above its reference and earlier sessions ({earlier})"
    below = "it was measured at {temperature}, {difference} below its reference and earlier sessions ({earlier})"
    away = say(above if outside > 0 else below, **parts)
    if worth:
        return say("{away}; temperature alone may account for {worth}", away=away, worth=worth)
    return say("{away}; temperature alone can cause or hide a change of unknown size", away=away)


def far_from_reference(celsius: float | None, reference: Residuals) -> str:
    """The sentence that a recording was made far from the temperatures of its calibration, with advice; empty where it
    was not, or where they are not known.
    """
    known = covered(reference, ())
    if celsius is None or known is None:
        return ""
    outside = celsius - min(max(celsius, known.lowest), known.highest)
    if abs(outside) <= LEAST_DIFFERENCE:
        return ""
    away = elsewhere(outside, celsius, (known.lowest, known.highest), "")
    return say("{problem}: {advice}.", problem=capitalised(away), advice=at_about(known.reference))


def worth_in(parameter: str, sensor: str, size: str) -> str:
    """``A2 bias: 80 ± 10 µg, tolerance 50 µg``."""
    return say(
        "{sensor} {parameter_names}: {size}", sensor=sensor, parameter_names=PARAMETER_NAMES[parameter], size=size
    )


def _between(lowest: float, highest: float) -> str:
    """``19–22 °C``."""
    low, high = number(lowest, 0), number(highest, 0)
    return in_degrees(lowest) if low == high else f"{low}–{in_degrees(highest)}"


MOST_SAID = 4
"""Parameters that a sentence lists."""
CONSTANT = 0.05
"""Least range of temperature, °C: a smaller one is stated as one number."""


def span_in_words(celsius: Array | None) -> str:
    """``19.8 to 22.3 °C``, of a session's readings."""
    return "not recorded" if celsius is None else _span(float(np.min(celsius)), float(np.max(celsius)))


def covered_in_words(known: CoveredTemperatures | None) -> str:
    """The temperatures that a unit's calibrations cover."""
    return "not known" if known is None else _span(known.lowest, known.highest)


def _span(low: float, high: float) -> str:
    if high - low <= CONSTANT:
        return f"{number(low, 1)}{THIN}°C"
    return say("{low} to {high}{thin_space}°C", low=number(low, 1), high=number(high, 1), thin_space=THIN)


def at_about(celsius: float) -> str:
    """The advice to measure again at a temperature."""
    return say("measure again at about {celsius}, or calibrate over temperature", celsius=in_degrees(celsius))


def in_degrees(celsius: float) -> str:
    """``35 °C``."""
    return f"{number(celsius, 0)}{HARD}°C"
