"""A plan in words and people's units: verdicts, detection limits, time."""

from estimator.applied_vector import STANDARD_GRAVITY
from estimator.causes import CATALOGUE
from estimator.diagnosis.results import Limit
from estimator.planning import Judged, Plan
from estimator.results import PARAMETERS
from estimator.session import ACCELEROMETER, GYROSCOPE
from service.measures import DEGREE, MEASURES, THIN, Measure, in_measure, number

VERDICTS = {
    "enough": "enough: U leaves the tolerance the share that was asked for",
    "usable": "usable: U stays within the tolerance, but takes more than its share",
    "undecidable": "undecidable: U exceeds the tolerance, or nothing is observed",
    "not judged": "no tolerance was given",
}
HOUR = 3600.0
ANGLE = MEASURES["accelerometer", "axis"]
UNSEEN = "not observable"
OF_GYROS = {cause.identifier for cause in CATALOGUE if cause.kind == GYROSCOPE}


def _limit_measures(kind: str) -> dict[str, Measure]:
    """People's unit of every SI unit of a cause's amplitude; the input is m/s² or rad/s."""
    zero = MEASURES[kind, "bias"]
    per = ("g", STANDARD_GRAVITY) if kind == ACCELEROMETER else ("(°/s)", DEGREE)
    top = ("µg", 1e6 / STANDARD_GRAVITY) if kind == ACCELEROMETER else ("µ°/s", 1e6 / DEGREE)
    return {
        "m/s²": zero,
        "rad": ANGLE,
        "1": Measure("ppm", 1e6),
        "m/s²/K": Measure(f"{zero.label}/°C", zero.factor),
        "1/K": Measure("ppm/°C", 1e6),
        "m/s²/(K/s)": Measure(f"{zero.label}/(°C/h)", zero.factor / HOUR),
        "m/s²/s": Measure(f"{zero.label}/h" if kind == ACCELEROMETER else "°/h²", zero.factor * HOUR),
        "1/s": Measure("ppm/h", 1e6 * HOUR),
        "rad/s": Measure(f"{ANGLE.label}/h", ANGLE.factor * HOUR),
        "(m/s²)⁻¹": Measure(f"{top[0]}/{per[0]}²", top[1] * per[1] ** 2),
        "(m/s²)⁻²": Measure(f"{top[0]}/{per[0]}³", top[1] * per[1] ** 3),
        "(rad/s)/(m/s²)": Measure("°/h/g", STANDARD_GRAVITY * 3600 / DEGREE),
    }


def limit_in_words(limit: Limit, kind: str) -> str:
    """``12 µg``, or why the plan cannot see the cause."""
    if limit.amplitude is None:
        return limit.reason.replace("the session", "the plan")
    if not limit.amplitude:
        return "corrected where it is found"
    units = _limit_measures(kind)
    worst = max(limit.amplitude)
    unit = units[limit.units[limit.amplitude.index(worst)]] if limit.units else Measure("", 1.0)
    return f"{number(float(f'{worst * unit.factor:.2g}'))}{THIN}{unit.label}"


def seen(plan: Plan) -> tuple[Limit, ...]:
    """Causes that the plan would find, with a size."""
    return tuple(limit for limit in plan.limits if limit.amplitude)


def blind(plan: Plan) -> tuple[Limit, ...]:
    """Causes that the plan cannot see; what only gyros have is left out where there are none."""
    has_gyros = any(s.kind == GYROSCOPE for s in plan.schedule.sensors)
    return tuple(one for one in plan.limits if one.amplitude is None and (has_gyros or one.cause not in OF_GYROS))


def unobserved(plan: Plan) -> str:
    """``scale and axis of every sensor; bias of A2``: what the plan does not observe; empty where it observes all."""
    sensors: dict[tuple[str, ...], list[str]] = {}
    for name in PARAMETERS:
        missing = tuple(j.sensor for j in plan.judged if j.parameter == name and j.sigma is None)
        if missing:
            sensors.setdefault(missing, []).append(name)
    everyone = tuple(s.name for s in plan.schedule.sensors)
    return "; ".join(
        f"{' and '.join(parameters)} of {'every sensor' if missing == everyone else ', '.join(missing)}"
        for missing, parameters in sensors.items()
    )


def sigma_in_words(judged: Judged, coverage: float) -> str:
    """``±2.1 µg``: the expanded uncertainty."""
    if judged.sigma is None:
        return UNSEEN
    unit = MEASURES[judged.kind, judged.parameter]
    return f"±{number(float(f'{coverage * judged.sigma * unit.factor:.2g}'))}{THIN}{unit.label}"


def tolerance_in_words(judged: Judged) -> str:
    """``of 50 µg``, empty where none was given."""
    if judged.tolerance is None:
        return ""
    unit = MEASURES[judged.kind, judged.parameter]
    return f"of {number(in_measure(judged.tolerance, unit))}{THIN}{unit.label}"


def duration(seconds: float) -> str:
    """``1 h 36 min``."""
    minutes = round(seconds / 60)
    hours, rest = divmod(minutes, 60)
    return f"{hours} h {rest} min" if hours else f"{rest} min"


def headline(plan: Plan) -> str:
    """What the plan comes to, in a sentence."""
    size = f"{plan.positions} positions in {'both runs' if len(plan.request.runs) == 2 else 'one run'}"
    if plan.reached is None:
        return f"{size}, {duration(plan.seconds)}: no tolerance was given to judge by."
    if plan.reached:
        return f"{size}, {duration(plan.seconds)}, reach every tolerance."
    short = [j for j in plan.judged if j.verdict in ("usable", "undecidable")]
    names = ", ".join(dict.fromkeys(j.parameter for j in short))
    return f"{size}, {duration(plan.seconds)}, do not reach the tolerance of {names}."
