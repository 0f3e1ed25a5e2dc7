"""Step: decisions on the sessions of a type → tolerances that its calibrations keep so far, for a person to confirm.

T = 3·s + U: s, the standard deviation of the changes from one session to another, is 1.4826 times the median of their
sizes, so that a unit that drifts among others does not set it; U is the median too. A unit of the same scatter passes
by more than U. Where only references were measured, it is the tolerance that they are judged by.
"""

from dataclasses import replace
from math import ceil, floor, log10
from statistics import median

from service.kit.measures import deviation_measure
from service.pages.type.tolerances import kinds_of
from service.sessions.records import PARAMETERS, Achieved
from service.sessions.store import Sessions
from service.storage.queries import Store
from service.types.records import Tolerances, UnitType, WantedTolerances
from service.types.rules import NOT_JUDGED

WITHIN = 3.0
"""Standard deviations of the changes that a tolerance allows."""
TO_SIGMA = 1.4826
"""Standard deviation of a normal law beside the median of its sizes."""
DIGITS = 2
"""Significant digits of a proposal, in the measure of the form."""


def proposed(store: Store, known: UnitType) -> WantedTolerances:
    """Tolerances that the sessions of the type's units keep; where they show nothing, the one in force."""
    found: dict[tuple[str, str], list[Achieved]] = {}
    for one in Sessions(store).achieved(known.name):
        found.setdefault((one.kind, one.parameter), []).append(one)
    first, *others = (
        (_proposed(kind, given, found) for kind, given in kinds_of(known)) if known.block else (NOT_JUDGED,)
    )
    return WantedTolerances(first, others[0] if others else None)


def _proposed(kind: str, known: Tolerances, found: dict[tuple[str, str], list[Achieved]]) -> Tolerances:
    new = {name: _rounded(kind, name, found[kind, name]) for name in PARAMETERS if (kind, name) in found}
    return replace(known, **new)


def _rounded(kind: str, parameter: str, achieved: list[Achieved]) -> float:
    """Up to two significant digits in the measure of the form, SI."""
    factor = deviation_measure(kind, parameter, 0.0).factor
    size = _kept(achieved) * factor
    step = 10.0 ** (floor(log10(size)) + 1 - DIGITS)
    return float(ceil(round(size / step, 6)) * step / factor)


def _kept(achieved: list[Achieved]) -> float:
    """T, SI or relative."""
    judged = [(abs(one.deviation), one.expanded) for one in achieved if one.deviation is not None and one.expanded]
    if not judged:
        return median(one.tolerance for one in achieved)
    return WITHIN * TO_SIGMA * median(size for size, _ in judged) + median(expanded for _, expanded in judged)
