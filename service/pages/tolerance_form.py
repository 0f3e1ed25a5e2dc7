"""The form of a unit type's tolerances: numbers in people's measures, empty where a parameter is not judged."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isclose, isfinite

from estimator.errors import Problem
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.errors import RefusedError
from service.measures import Measure, deviation_measure, in_measure
from service.records.session import PARAMETERS
from service.records.unit import Tolerances, UnitType
from service.words.names import heading

SAME = 1e-9
"""Relative: what a number loses as it is written and read again; so much is no change."""
LEAST, MOST = 1e-15, 1e6
"""SI; as the API has it."""
SHORTEST, LONGEST = 1, 36_525
"""Days: from one to a hundred years."""
INTERVAL = "interval"


@dataclass(frozen=True)
class ToleranceField:
    """One number."""

    key: str
    label: str
    unit: str
    value: str
    """As it is in force; empty where it is not judged."""


@dataclass(frozen=True)
class Wanted:
    """What the form asks for."""

    tolerances: Tolerances
    gyro_tolerances: Tolerances | None
    interval_days: float


def tolerance_fields(known: UnitType) -> tuple[ToleranceField, ...]:
    """What can be set, with what is in force."""
    return tuple(
        ToleranceField(
            f"{kind}.{name}", _label(known, kind, name), _measure(kind, name).label, _text(kind, name, given)
        )
        for kind, given in _kinds(known)
        for name in PARAMETERS
    )


def days(known: UnitType) -> str:
    """The longest interval as the form has it."""
    return f"{known.maximum_interval_days:.12g}"


def wanted(known: UnitType, form: Mapping[str, str]) -> Wanted:
    """What a form asks for; RefusedError with every number that is none."""
    faults: list[Problem] = []
    read = {kind: Tolerances(**{name: _read(kind, name, given, form, faults) for name in PARAMETERS})
            for kind, given in _kinds(known)}  # fmt: skip
    interval = _number(INTERVAL, form.get(INTERVAL, days(known)), faults)
    if interval is None or not SHORTEST <= interval <= LONGEST:
        faults.append(Problem(INTERVAL, f"must be between {SHORTEST} and {LONGEST:,} days"))
    if faults or interval is None:
        raise RefusedError("The tolerances cannot be set.", tuple(faults))
    own, *others = read.values()
    return Wanted(own, others[0] if others else None, interval)


def _kinds(known: UnitType) -> tuple[tuple[str, Tolerances], ...]:
    """Kinds of sensor with their tolerances."""
    if known.gyro_tolerances is None:
        return ((known.block, known.tolerances),)
    return (ACCELEROMETER, known.tolerances), (GYROSCOPE, known.gyro_tolerances)


def _label(known: UnitType, kind: str, name: str) -> str:
    return heading(name) if known.gyro_tolerances is None else f"{heading(name)}, {kind}s"


def _measure(kind: str, name: str) -> Measure:
    """Always the fine one, so that a number never changes its meaning with its size."""
    return deviation_measure(kind, name, 0.0)


def _text(kind: str, name: str, given: Tolerances) -> str:
    shown = in_measure(getattr(given, name), _measure(kind, name))
    return "" if shown is None else f"{shown:.12g}"


def _read(kind: str, name: str, given: Tolerances, form: Mapping[str, str], faults: list[Problem]) -> float | None:
    """SI; what is in force where the number was not changed."""
    key, current = f"{kind}.{name}", getattr(given, name)
    text = form.get(key, _text(kind, name, given)).strip()
    number = _number(key, text, faults) if text else None
    if number is None:
        return None
    tolerance = number / _measure(kind, name).factor
    if current is not None and isclose(tolerance, current, rel_tol=SAME):
        return float(current)
    if not LEAST <= tolerance <= MOST:
        faults.append(Problem(key, "must be larger than nothing, and no larger than can be measured"))
    return tolerance


def _number(key: str, text: str, faults: list[Problem]) -> float | None:
    """A number with a point or a comma; None, and a fault, where it is none."""
    try:
        found = float(text.strip().replace(",", "."))
    except ValueError:
        found = float("nan")
    if isfinite(found):
        return found
    faults.append(Problem(key, "is not a number"))
    return None
