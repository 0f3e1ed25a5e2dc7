"""Sizes and places of causes, in practical measures."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import isfinite, nan
from typing import Protocol

from estimator.applied_vector import EARTH_RATE, STANDARD_GRAVITY
from estimator.causes import find
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Shared
from estimator.message import joined, say
from estimator.moments import duration
from service.kit.measures import (
    ARCSEC,
    COVERAGE,
    DEGREE,
    HARD,
    PPM,
    READABLE,
    THIN,
    Measure,
    decimals,
    measured,
    number,
)

PER_HOUR = 3600.0
"""Seconds in an hour."""
MICRO_G = 1e6 / STANDARD_GRAVITY
"""Micro-g in one m/s²."""
AMPLITUDE_MEASURES = {
    "1": PPM,
    "1/K": Measure("ppm/K", 1e6),
    "1/K²": Measure("ppm/K²", 1e6),
    "1/s": Measure("ppm/h", 1e6 * PER_HOUR),
    "m/s²": Measure("µg", MICRO_G),
    "m/s²/K": Measure("µg/K", MICRO_G),
    "m/s²/K²": Measure("µg/K²", MICRO_G),
    "m/s²/s": Measure("µg/h", MICRO_G * PER_HOUR),
    "m/s²/(K/s)": Measure("µg/(K/h)", MICRO_G / PER_HOUR),
    "(m/s²)⁻¹": Measure("µg/g²", 1e6 * STANDARD_GRAVITY),
    "(m/s²)⁻²": Measure("µg/g³", 1e6 * STANDARD_GRAVITY**2),
    "m": Measure("cm", 100.0),
    "rad": ARCSEC,
    "rad/s": Measure("°/h", PER_HOUR / DEGREE),
    "rad/s/K": Measure("(°/h)/K", PER_HOUR / DEGREE),
    "rad/s/K²": Measure("(°/h)/K²", PER_HOUR / DEGREE),
    "rad/s/s": Measure("(°/h)/h", PER_HOUR**2 / DEGREE),
    "rad/s/(K/s)": Measure("(°/h)/(K/h)", 1 / DEGREE),
    "(rad/s)⁻¹": Measure(say("ppm at Earth rate"), 1e6 * EARTH_RATE),
    "(rad/s)⁻²": Measure(say("ppm at Earth rate"), 1e6 * EARTH_RATE**2),
    "(rad/s)/(m/s²)": Measure("(°/h)/g", PER_HOUR / DEGREE * STANDARD_GRAVITY),
}
"""Practical measure of a cause's amplitude, by its SI unit. A gyro on a stand feels the Earth's rate alone, so its
nonlinearity is read as its effect there.
"""
COARSER = {
    "ppm": Measure("%", 1e2),
    "µg": Measure("mg", 1e3 / STANDARD_GRAVITY),
    "arcsec": Measure("°", 1 / DEGREE),
}
"""Coarser measures for large amplitudes, by the label of the fine measure."""


def amplitude_measure(cause: str, si_unit: str, largest: float) -> Measure:
    """The measure for amplitudes of a cause up to ``largest`` (SI)."""
    known = find(cause)
    if si_unit == "rad/s" and known is not None and known.grows_an_angle:
        return Measure("arcsec/h", ARCSEC.factor * PER_HOUR)
    measure = AMPLITUDE_MEASURES.get(si_unit, Measure(si_unit, 1.0))
    return measure if abs(largest) * measure.factor < READABLE else COARSER.get(measure.label, measure)


AT_ROWS = {"from": "from row {value}", "at": "at row {value}"}
"""Phrases for a cause that has its row."""
NUMBERED = re.compile(r" \d+$")
"""End of a name that distinguishes two nonlinear parameters of one unit: ``row 1``, ``row 2``."""


FINE = 0.01
"""Share of a measure: an uncertainty below it is read in a finer one, where there is one."""


class Sized(Protocol):
    """A finding of a session or of a group, with amplitudes."""

    @property
    def cause(self) -> str: ...
    @property
    def sensors(self) -> tuple[str, ...]: ...
    @property
    def amplitude(self) -> tuple[float, ...]: ...
    @property
    def sigma(self) -> Sequence[float | None]: ...
    @property
    def units(self) -> tuple[str, ...]: ...


@dataclass(frozen=True)
class Amounts:
    """Amplitudes alone."""

    cause: str
    sensors: tuple[str, ...]
    amplitude: tuple[float, ...]
    sigma: tuple[float, ...]
    units: tuple[str, ...]


def amplitudes_of(finding: Sized) -> Iterator[str]:
    """Every amplitude ± U; named by sensor where several share the cause."""
    width = max(1, len(finding.amplitude) // max(1, len(finding.sensors)))
    stated = zip(finding.amplitude, finding.sigma, finding.units, strict=False)
    for k, (value, known, si_unit) in enumerate(stated):
        sigma = nan if known is None else known
        if not _is_stated(value) and not _is_stated(sigma):
            continue
        expanded = COVERAGE * sigma
        who = say("{sensors}: ", sensors=finding.sensors[k // width]) if len(finding.sensors) > 1 else ""
        which = say("{cause} ", cause=part_of(finding.cause, k % width)) if width > 1 else ""
        yield joined("", (who, which, _size(finding.cause, si_unit, value, expanded)))


def _size(cause: str, si_unit: str, value: float, expanded: float) -> str:
    """The size with its uncertainty, ``12.3 ± 1.4 µg``; an uncertainty far below the measure of the size has its ± in
    the finer one: ``42.66433° ± 1.2 arcsec``.
    """
    largest = max(abs(x) if isfinite(x) else 0.0 for x in (value, expanded))
    measure, finer = amplitude_measure(cause, si_unit, largest), amplitude_measure(cause, si_unit, expanded)
    if measure == finer or not isfinite(expanded) or expanded * measure.factor >= FINE:
        return measured(value, expanded, measure)
    shown = number(value * measure.factor, decimals(expanded * measure.factor))
    spread = expanded * finer.factor
    return f"{shown}{THIN}{measure.label}{HARD}±{HARD}{number(spread, decimals(spread))}{THIN}{finer.label}"


def _is_stated(value: float) -> bool:
    """Whether a number says anything: an amplitude that took no part is 0 ± 0."""
    return isfinite(value) and value != 0


def part_of(cause: str, k: int) -> str:
    """The name of one of several amplitudes."""
    known = find(cause)
    return known.amplitude_words[k] if known and known.amplitude_words else f"k{k + 1} ="


def shape_of(finding: Finding) -> str:
    """``time constant 812 s``, ``from row 14``; ``A1: from row 14; A2: from row 20`` where they differ. Of what settles
    also when its size is counted from."""
    shape, known = _alone(finding), find(finding.cause)
    if known is None or not known.since_power_on or not shape:
        return shape
    if finding.since_power_on is None:
        return say("{shape}; size at the session's start", shape=shape)
    begun = duration(finding.since_power_on)
    return say("{shape}; size at switching on, {begun} before the first reading", shape=shape, begun=begun)


def _alone(finding: Finding) -> str:
    """The shape of the cause, for each sensor where they differ."""
    if finding.shared is not None:
        return _shared_shape(finding.cause, finding.shared)
    values = finding.nonlinear_each
    if len(values) < 2 or all(shape == values[0] for shape in values):
        return _shape(finding.cause, finding.nonlinear)
    shapes = (_shape(finding.cause, shape) for shape in values)
    return joined(
        "; ",
        (
            say("{sensor}: {shape}", sensor=who, shape=shape)
            for who, shape in zip(finding.sensors, shapes, strict=False)
            if shape
        ),
    )


def _shared_shape(cause: str, shared: Shared) -> str:
    """``time constant 690 ± 40 s``: the one shape of all sensors."""
    known, text = find(cause), []
    for name, value in shared.shape.items():
        spread, measure = COVERAGE * shared.shape_sigma.get(name, nan), amplitude_measure(cause, name, value)
        text.append(measured(value, spread, measure) if isfinite(spread) else _place(cause, name, value))
    words = known.shape_words if known else ""
    shape = joined(" ", filter(None, (words, joined(" and ", text)))) if text else ""
    if not (shape and shared.shape_in_doubt):
        return shape
    return say("{shape}; whether each sensor has its own cannot be told from this session", shape=shape)


def more_of(finding: Finding) -> tuple[str, ...]:
    """The sensors that follow a shared course below what can be named of one alone, with their sizes ± U."""
    shared = finding.shared
    if shared is None or not shared.more:
        return ()
    unit = finding.units[:1] * len(shared.more)
    sized = Amounts(finding.cause, shared.more, shared.more_amplitude, shared.more_sigma, unit)
    sizes = tuple(amplitudes_of(sized))
    return (
        sizes
        if len(shared.more) > 1
        else tuple(say("{sensor}: {shape}", sensor=shared.more[0], shape=size) for size in sizes)
    )


def _shape(cause: str, nonlinear: dict[str, float]) -> str:
    places = tuple(filter(None, (_place(cause, unit, value) for unit, value in nonlinear.items())))
    known = find(cause)
    words = known.shape_words if known else ""
    if words in AT_ROWS and tuple(nonlinear) == ("row",):
        return say(AT_ROWS[words], value=number(nonlinear["row"], 0))
    return joined(" ", filter(None, (words, joined(" and ", places)))) if places else ""


def _place(cause: str, name: str, value: float) -> str:
    """One nonlinear parameter: a row, a side of the range, or a quantity; two of one unit are numbered."""
    si_unit = NUMBERED.sub("", name)
    if si_unit == "row":
        return say("row {number}", number=number(value, 0))
    if si_unit == "side":
        return "upper side" if value > 0 else "lower side" if value < 0 else ""
    measure = amplitude_measure(cause, si_unit, value)
    return f"{number(value * measure.factor)}{THIN}" + measure.label
