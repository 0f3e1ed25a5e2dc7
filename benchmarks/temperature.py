"""``python -m benchmarks.temperature --units 40 --seed 1`` writes docs/diagnosis/temperature.md.

Units whose zeros and scale factors follow the temperature, by lines or parabolas that the estimator's code does not
share: over the sessions of a unit, between two sessions, and within one.
"""

import argparse
import os
import sys
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import date, timedelta
from functools import partial
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import in_full, publish
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from benchmarks.temperature_law import LINE, NONE, PAGE, PARABOLA, ROOM, TOLERANCES, WARM, law_of, with_section
from estimator import calibrate, diagnose, read_session
from estimator.causes import cause as hidden
from estimator.health import judge
from estimator.health.deviation import deviation
from estimator.health.pooled import general_prior
from estimator.health.prognosis import Outlook, Track, prognosis
from estimator.results import Calibration
from estimator.session import ACCELEROMETER, Array
from tests.blind.cases import draw_case
from tests.blind.warmth import at_temperature, draw_unit_at_room

LINES, CURVES = ("bias-temperature", "scale-temperature"), ("bias-temperature-curve", "scale-temperature-curve")
OF_TEMPERATURE = frozenset({*LINES, "unexplained"})
SWING = 10.0
"""°C to either side of the room through the year."""
SESSIONS = 12
STEADY = 0.05
"""°C by which the room wanders within a session of a history: what it does to a session is asked apart."""
SHOWN = 0.5
"""Tolerances that a law is worth over the year, from which on it should be found."""
BENDLESS = ", or the line where the bend does not show"
APART = 5.0
"""Standard errors to the nearest rival from which on a name should be right."""

INTRODUCTION = (
    "Blocks of four accelerometers whose zeros and scale factors follow the temperature by laws that are worth some "
    f"150 µg and 300 ppm in 15 °C, along lines or parabolas. Histories: {SESSIONS} sessions over three years at "
    f"{ROOM:.0f} ± {SWING:.0f} °C through the year, judged by the default tolerances, of a type that nothing is known "
    "of. Within a session: units, schedules and temperatures drawn at random, strength 8 to 40. The physics is written "
    "a second time, apart from the estimator. Intervals: 95 % (Wilson)."
)


@dataclass(frozen=True)
class Lived:
    """The history of one unit."""

    flagged: bool
    """Whether any parameter is said to jump or drift."""
    found: tuple[bool, ...]
    """Whether each law with an effect of `SHOWN` or more is found."""
    claimed: tuple[bool, ...]
    """Whether a law is found for each parameter that follows nothing."""


@dataclass(frozen=True)
class Carried:
    """A session at another temperature than its reference."""

    drifts: bool
    alone: bool
    """Whether a drift stands without temperature beside it."""
    replaced: bool
    """Whether an adjustment or a replacement is advised."""


@dataclass(frozen=True)
class Named:
    """One effect within a session."""

    apart: bool
    """Whether it can be told from every rival."""
    first: bool
    told: bool
    """Whether it is named or listed, or named without its bend."""


def lived(kind: str, seed: tuple[int, ...]) -> Lived:
    """Three years of one unit."""
    rng = np.random.default_rng(seed)
    world, law = draw_unit_at_room(rng), law_of(kind, rng)
    days = np.cumsum(rng.uniform(50, 140, SESSIONS))
    warm = ROOM + SWING * np.sin(2 * np.pi * days / 365.25 + rng.uniform(0, 2 * np.pi)) + rng.normal(0, 1, SESSIONS)
    made = [calibrate(read_session(_file(world, law, at, day, rng))) for day, at in zip(days, warm, strict=True)]
    histories = tracks(made, days / 365.25, warm)
    outlooks = prognosis(list(histories.values()), [general_prior()] * len(histories), np.zeros(1)).outlooks
    by_place = dict(zip(histories, outlooks, strict=True))
    worth = {
        (name, parameter): _worth(law[row, i], warm) / TOLERANCES[ACCELEROMETER, parameter]
        for row, parameter in enumerate(("bias", "scale"))
        for i, name in enumerate(world.unit.names)
    }
    return Lived(
        flagged=any(outlook.changes for outlook in outlooks),
        found=tuple(_is_found(by_place[place]) for place, worthy in worth.items() if worthy >= SHOWN),
        claimed=tuple(_is_found(by_place[place]) for place, worthy in worth.items() if worthy == 0),
    )


def _file(world: object, law: Array, celsius: float, day: float, rng: np.random.Generator) -> dict[str, object]:
    at = date(2022, 1, 1) + timedelta(days=int(day))
    return at_temperature(world, law, float(celsius), at.isoformat(), rng, STEADY)


def _worth(law: Array, warm: Array) -> float:
    """Effect of a line and a parabola (2,), over the range of the temperatures (n,) of the sessions."""
    away = warm - ROOM
    return float(np.ptp(law[0] * away + law[1] * away**2))


def _is_found(outlook: Outlook) -> bool:
    return outlook.warmth is not None and outlook.warmth.is_found


def tracks(made: Sequence[Calibration], years: Array, warm: Array) -> dict[tuple[str, str], Track]:
    """The history of every parameter that is judged, as the service makes it of sessions that span temperature."""
    first, rows = made[0], dict[tuple[str, str], list[tuple[tuple[float, ...], ...]]]()
    for one in made[1:]:
        for found in judge(one, first, TOLERANCES):
            whole = deviation(one.sensor(found.sensor), first.sensor(found.sensor), found.parameter)
            own: tuple[tuple[float, ...], ...] = (found.change, found.change_own, found.change_origin)
            if whole is not None and found.parameter != "axis":
                sigmas = (float(np.sqrt(part[0, 0])) for part in (whole.current, whole.origin))
                own = ((float(whole.vector[0]),), *((sigma,) for sigma in sigmas))
            rows.setdefault((found.sensor, found.parameter), []).append(own)
    return {
        place: Track(
            time=years - years[0],
            change=np.array([[0.0] * len(own[0][0]), *(change for change, _, _ in own)]),
            sigma=np.array([own[-1][2], *(sigma for _, sigma, _ in own)]),
            tolerance=TOLERANCES[ACCELEROMETER, place[1]],
            temperature=warm,
        )
        for place, own in rows.items()
    }


def carried(kind: str, seed: tuple[int, ...]) -> Carried:
    """A reference at `ROOM`, and a session at `WARM`."""
    rng = np.random.default_rng(seed)
    world, law = draw_unit_at_room(rng), law_of(kind, rng)
    reference = read_session(at_temperature(world, law, ROOM, "2026-01-10", rng))
    found = diagnose(read_session(at_temperature(world, law, WARM, "2026-04-10", rng)), [reference]).findings
    drifts = [f for f in found if f.cause == "sensor-drift"]
    alone = any(not OF_TEMPERATURE & {*f.alternatives} for f in drifts)
    return Carried(bool(drifts), alone, any("replacement" in f.advice for f in drifts))


def named(cause: str, seed: tuple[int, ...]) -> Named:
    """A cause hidden in a session."""
    case = draw_case("single", seed, cause)
    found = diagnose(read_session(case.session), [read_session(one) for one in case.history]).findings
    told = any(cause in (f.cause, *f.alternatives) or f.cause in hidden(cause).contains for f in found)
    return Named(case.truths[0].separation >= APART, bool(found) and found[0].cause == cause, told)


def is_named(seed: tuple[int, ...]) -> bool:
    """Whether anything is named in a sound session."""
    case = draw_case("none", seed)
    return bool(diagnose(read_session(case.session), [read_session(one) for one in case.history]).findings)


@dataclass(frozen=True)
class Answers:
    """All results."""

    lived: dict[str, list[Lived]]
    carried: dict[str, list[Carried]]
    named: dict[str, list[Named]]
    sound: list[bool]


def performed(run: Callable[..., Iterator[object]], units: int, seed: int) -> Answers:
    """Runs so many of every kind; sound sessions three times as many."""

    def each(work: Callable[..., object], number: int, kinds: Sequence[str]) -> dict[str, list[object]]:
        found = {k: list(run(partial(work, k), seeds(number, i, units))) for i, k in enumerate(kinds)}
        print(f"{work.__name__} done", file=sys.stderr)
        return found

    def seeds(number: int, kind: int, count: int) -> list[tuple[int, ...]]:
        return [(seed, number, kind, k) for k in range(count)]

    return Answers(
        lived=each(lived, 1, (NONE, LINE, PARABOLA)),
        carried=each(carried, 2, (LINE, PARABOLA)),
        named=each(named, 3, (*CURVES, *LINES)),
        sound=list(run(is_named, seeds(4, 0, 3 * units))),
    )


def page(answers: Answers, command: str) -> str:
    """Markdown."""
    measured = in_full(table(("", "target", "measured"), rows(answers)))
    return (
        f"# Temperature\n\nMade by `{command}`. {INTRODUCTION}\n\n"
        f"[Every target, and what is measured](shared-causes.md#temperature).\n\n{measured}\n"
    )


def rows(answers: Answers) -> Iterator[tuple[str, str, object]]:
    """Rows of the table."""
    for kind in (LINE, PARABOLA):
        seen = answers.carried[kind]
        head = f"reference at {ROOM:.0f}, session at {WARM:.0f} °C, {kind}"
        yield f"{head}: `sensor-drift` named", "", rate([one.drifts for one in seen])
        yield f"{head}: without temperature beside it", "0", rate([one.alone for one in seen])
        yield f"{head}: adjustment or replacement advised", "0", rate([one.replaced for one in seen])
    for kind in (LINE, PARABOLA):
        units = answers.lived[kind]
        yield f"seasons, {kind}: units flagged", "≤ 1 %", rate([one.flagged for one in units])
        words = f"seasons, {kind}: laws worth {SHOWN:g} T found"
        yield words, "≥ 95 %", rate([mark for one in units for mark in one.found])
    units = answers.lived[NONE]
    yield "seasons, nothing follows them: units flagged", "≤ 1 %", rate([one.flagged for one in units])
    yield "the same: laws claimed, of parameters", "≤ 1 %", rate([mark for one in units for mark in one.claimed])
    for cause in (*CURVES, *LINES):
        apart = [one for one in answers.named[cause] if one.apart]
        yield f"`{cause}`, {APART:g} from every rival: named first", "≥ 95 %", rate([one.first for one in apart])
        words = f"`{cause}`, all of strength 8: named or listed{BENDLESS * (cause in CURVES)}"
        yield words, "≥ 99 %", rate([one.told for one in answers.named[cause]])
    yield "sound sessions: a name", "≤ 1 %", rate(answers.sound)


def main() -> None:
    """Run it and write its page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.temperature", description=__doc__)
    parser.add_argument("--units", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        answers = performed(pool.map, options.units, options.seed)
    text = page(answers, f"python -m benchmarks.temperature --units {options.units} --seed {options.seed}")
    publish(with_section(text) if options.out == PAGE else text, options.out)
    print(f"\n{text}")


if __name__ == "__main__":
    main()
