"""A plan in words: verdicts, what it would find and cannot see, time."""

from estimator.causes import CATALOGUE
from estimator.message import joined, say
from estimator.planning import Judged, Plan
from estimator.results import PARAMETERS
from estimator.session import GYROSCOPE
from service.diagnosis.words.limits import BlindCauses, SeenCause, blind_causes, seen_causes
from service.kit.measures import MEASURES, THIN, in_measure, number

VERDICTS = {
    "enough": "enough: U leaves the tolerance the share that was asked for",
    "usable": "usable: U stays within the tolerance, but takes more than its share",
    "undecidable": "undecidable: U exceeds the tolerance, or nothing is observed",
    "not judged": "no tolerance was given",
}
"""What the verdicts of a plan mean."""
UNSEEN = "not observable"
OF_GYROS = frozenset(cause.identifier for cause in CATALOGUE if cause.kind == GYROSCOPE)
"""Causes that an accelerometer cannot have."""


def seen(plan: Plan) -> tuple[SeenCause, ...]:
    """Causes that the plan would find, with the size from which on."""
    return seen_causes(plan.limits, {sensor.kind for sensor in plan.schedule.sensors})


def blind(plan: Plan) -> tuple[BlindCauses, ...]:
    """Causes that the plan cannot see; what only gyros have is left out where there are none."""
    has_gyros = any(s.kind == GYROSCOPE for s in plan.schedule.sensors)
    return blind_causes([one for one in plan.limits if has_gyros or one.cause not in OF_GYROS])


def unobserved(plan: Plan) -> str:
    """``scale and axis of every sensor; bias of A2``: what the plan does not observe; empty where it observes all."""
    sensors: dict[tuple[str, ...], list[str]] = {}
    for name in PARAMETERS:
        missing = tuple(j.sensor for j in plan.judged if j.parameter == name and j.sigma is None)
        if missing:
            sensors.setdefault(missing, []).append(name)
    everyone = tuple(s.name for s in plan.schedule.sensors)
    return joined(
        "; ",
        (
            say(
                "{parameters} of {missing}",
                parameters=joined(" and ", parameters),
                missing="every sensor" if missing == everyone else joined(", ", missing),
            )
            for missing, parameters in sensors.items()
        ),
    )


def sigma_in_words(judged: Judged, coverage: float) -> str:
    """``±2.1 µg``: the expanded uncertainty."""
    if judged.sigma is None:
        return UNSEEN
    measure = MEASURES[judged.kind, judged.parameter]
    return f"±{number(float(f'{coverage * judged.sigma * measure.factor:.2g}'))}{THIN}" + measure.label


def tolerance_in_words(judged: Judged) -> str:
    """``of 50 µg``, empty where none was given."""
    if judged.tolerance is None:
        return ""
    measure = MEASURES[judged.kind, judged.parameter]
    return say(
        "of {tolerance}{thin}{label}",
        tolerance=number(in_measure(judged.tolerance, measure)),
        thin=THIN,
        label=measure.label,
    )


def duration(seconds: float) -> str:
    """``1 h 36 min``."""
    minutes = round(seconds / 60)
    hours, rest = divmod(minutes, 60)
    return say("{hours} h {rest} min", hours=hours, rest=rest) if hours else say("{rest} min", rest=rest)


def headline(plan: Plan) -> str:
    """What the plan comes to, in a sentence."""
    size = (
        say("{positions} positions in both runs", positions=plan.positions)
        if len(plan.request.runs) == 2
        else say("{positions} positions in one run", positions=plan.positions)
    )
    if plan.reached is None:
        return say("{size}, {seconds}: no tolerance was given to judge by.", size=size, seconds=duration(plan.seconds))
    if plan.reached:
        return say("{size}, {seconds}, reach every tolerance.", size=size, seconds=duration(plan.seconds))
    short = [j for j in plan.judged if j.verdict in ("usable", "undecidable")]
    names = joined(", ", dict.fromkeys(j.parameter for j in short))
    return say(
        "{size}, {seconds}, do not reach the tolerance of {names}.",
        size=size,
        seconds=duration(plan.seconds),
        names=names,
    )
