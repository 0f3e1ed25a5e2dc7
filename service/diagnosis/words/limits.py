"""What a session would have found, and what it cannot see."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from math import isfinite

from estimator.causes import find
from estimator.diagnosis.results import Limit
from estimator.message import joined
from estimator.session import GYROSCOPE
from service.diagnosis.words.amplitude_measures import amplitude_measure
from service.diagnosis.words.causes import cause_name
from service.kit.measures import THIN, leading_kind, number

FULLER = {"the session lacks vibration": "no vibration was recorded, or it was the same everywhere"}
"""Reasons that people would take for something else as the estimator puts them."""


@dataclass(frozen=True)
class SeenCause:
    """The smallest effect of one cause that would have been found."""

    cause: str
    size: str


@dataclass(frozen=True)
class BlindCauses:
    """Causes that the session cannot see, and why."""

    causes: str
    reason: str


def seen_causes(limits: Sequence[Limit], kinds: Collection[str]) -> tuple[SeenCause, ...]:
    """Causes that a session would find, with the size from which on, at sensors of these kinds."""
    kind = leading_kind(kinds)
    return tuple(SeenCause(cause_name(limit.cause), size_of(limit, kind)) for limit in limits if limit.amplitude)


def blind_causes(limits: Sequence[Limit]) -> tuple[BlindCauses, ...]:
    """Causes that a session cannot see, by reason."""
    names: dict[str, list[str]] = {}
    for limit in limits:
        if limit.amplitude is None:
            names.setdefault(FULLER.get(limit.reason, limit.reason), []).append(cause_name(limit.cause))
    return tuple(BlindCauses(joined(", ", causes), reason) for reason, causes in names.items())


def size_of(limit: Limit, kind: str) -> str:
    """Every amplitude once: two that agree to a tenth are one number."""
    stated = zip(limit.amplitude or (), limit.units, strict=False)
    shown = (_amplitude(limit.cause, value, _unit(limit.cause, si_unit, kind)) for value, si_unit in stated)
    return joined("; ", dict.fromkeys(filter(None, shown))) or "–"


def _unit(cause: str, si_unit: str, kind: str) -> str:
    """A limit states its unit as for an accelerometer; where a gyro is meant, m/s² is rad/s."""
    known = find(cause)
    is_of_both = known is not None and known.kind is None
    return si_unit.replace("m/s²", "rad/s") if kind == GYROSCOPE and is_of_both else si_unit


def _amplitude(cause: str, value: float, si_unit: str) -> str:
    if not isfinite(value):
        return ""
    measure = amplitude_measure(cause, si_unit, value)
    return f"{number(float(f'{value * measure.factor:.2g}'))}{THIN}" + measure.label
