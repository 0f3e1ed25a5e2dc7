"""``python -m benchmarks.temperature_law --units 40 --seed 1`` writes a section of docs/diagnosis/temperature.md.

Units with a reference at 20 °C, seven sessions at other temperatures and one at 35 °C, judged as measured and by the
law that the sessions before it tell.
"""

import argparse
import os
import re
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import date, timedelta
from functools import partial
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import in_full, publish, published
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import calibrate, read_session
from estimator.applied_vector import STANDARD_GRAVITY
from estimator.groups.type_laws import UnitHistory, type_laws
from estimator.health import ParameterJudgement, judge
from estimator.health.temperature_law import Seen, Steps, temperature_steps
from estimator.health.type_law import TypeLaw
from estimator.results import ARCSEC, Calibration
from estimator.session import ACCELEROMETER, Array
from tests.blind.warmth import at_temperature, draw_law, draw_unit_at_room, stepped
from tests.blind.world import Session

PAGE = Path(__file__).parents[1] / "docs" / "diagnosis" / "temperature.md"
HEADING = "## A session judged at its reference's temperature"
NONE, LINE, PARABOLA, LOOSE = "none", "line", "parabola", "line with a small bend and lag"
CASES = ((LINE, 8), (PARABOLA, 8), (LOOSE, 8), (LOOSE, 16), (NONE, 8), (LINE, 4), (PARABOLA, 4), (LOOSE, 4))
"""Law, and sessions before, the reference among them."""
TYPE_UNITS, TYPE_SESSIONS = 20, 12
"""Other units of the type, and the sessions of each, that the laws of a type are learned from."""
TOLERANCES = {
    (ACCELEROMETER, "bias"): 50e-6 * STANDARD_GRAVITY,
    (ACCELEROMETER, "scale"): 100e-6,
    (ACCELEROMETER, "axis"): 20 * ARCSEC,
}
"""Tolerances that hold until an engineer sets others."""
ROOM, WARM = 20.0, 35.0
COLDEST, WARMEST = 10.0, 37.0
"""°C between which the sessions before are measured."""
EVERY = 60
"""Days between them."""
LAG = 0.7
"""°C, one standard deviation by which the sensors are at another temperature than the file says."""
BEND = 0.2
"""Part of the bend of a parabola."""
UNFIT = ("fail", "conditional-fail")
FEW = 100
"""Below so many the page says of how many a share is."""


@dataclass(frozen=True)
class Answer:
    """The answer to one unit at `WARM` by laws learned from some sessions."""

    by_law: bool
    """Whether it was called unfit at the reference's temperature."""
    undecided: bool
    """Whether it was neither fit nor unfit then."""
    covered: tuple[bool, ...]
    """Whether U covers the remainder of each corrected parameter: nothing moved."""
    shares: tuple[float, ...]
    """U of each corrected parameter, in tolerances."""
    found: bool
    """Whether a sensor whose bias has moved by 150 µg is called unfit by the law, for its bias."""
    excused: bool
    """Whether a sensor passes that moved when the room became warmer for good."""


@dataclass(frozen=True)
class Judged:
    """One unit at `WARM`."""

    as_measured: bool
    """Whether it was called unfit without a law."""
    own: Answer
    """The answer by its own sessions."""
    typed: Answer
    """The answer with the laws of its type."""


def law_of(kind: str, rng: np.random.Generator) -> Array:
    """(2, 4, 2) laws of one kind, as `draw_law` gives them."""
    if kind == LOOSE:
        line, bend = draw_law(4, rng, curved=False), draw_law(4, rng, curved=True)
        return np.stack([line[..., 0], BEND * bend[..., 1]], axis=-1)
    return draw_law(4, rng, curved=kind == PARABOLA) * (kind != NONE)


@dataclass(frozen=True)
class Unit:
    """One unit with its law."""

    world: Session
    law: Array
    lag: float

    def at(self, celsius: float, number: int, rng: np.random.Generator) -> Seen:
        """The session of a number, counted from the reference."""
        day = (date(2024, 1, 10) + timedelta(days=EVERY * number)).isoformat()
        lag = float(rng.normal(0, self.lag)) if self.lag else 0.0
        document = at_temperature(self.world, self.law, celsius, day, rng, lag=lag)
        return Seen(EVERY * number / 365.25, celsius, calibrate(read_session(document)))


@dataclass(frozen=True, eq=False)
class Scene:
    """One unit with its sessions before, and the same unit when it has changed."""

    unit: Unit
    seen: tuple[Seen, ...]
    last: Seen
    moved: Seen
    """The last one of a unit of which one bias moved before it."""
    name: str
    """Name of that sensor."""
    stayed: tuple[Seen, ...]
    """Sessions of a unit whose bias moved when the room became warmer for good; empty where that is not asked."""


def learned_laws(kind: str, seed: int) -> tuple[TypeLaw, ...]:
    """The laws of a type whose units follow one kind of law."""
    return type_laws([_other(kind, (seed, 99, i)) for i in range(TYPE_UNITS)], TOLERANCES)


def _other(kind: str, seed: tuple[int, ...]) -> UnitHistory:
    rng = np.random.default_rng(seed)
    unit = _draw(kind, rng)
    seen = _before(unit, TYPE_SESSIONS, rng)
    return UnitHistory(seen[0].calibration, seen)


def _draw(kind: str, rng: np.random.Generator) -> Unit:
    world, law = draw_unit_at_room(rng), law_of(kind, rng)
    return Unit(world, law, LAG if kind == LOOSE else 0.0)


def _before(unit: Unit, learned: int, rng: np.random.Generator) -> tuple[Seen, ...]:
    warm = (ROOM, *rng.uniform(COLDEST, WARMEST, learned - 1))
    return tuple(unit.at(float(t), i, rng) for i, t in enumerate(warm))


def judged(kind: str, learned: int, laws: Sequence[TypeLaw], seed: tuple[int, ...]) -> Judged:
    """A unit of one kind of law, after so many sessions."""
    rng = np.random.default_rng(seed)
    unit = _draw(kind, rng)
    seen, last = _before(unit, learned, rng), unit.at(WARM, learned, rng)
    changed, name = stepped(unit.world, rng)
    moved = Unit(changed, unit.law, unit.lag).at(WARM, learned, rng)
    stayed = _stayed(unit.world, changed, learned // 2, rng) if kind == NONE else ()
    scene = Scene(unit, seen, last, moved, name, stayed)
    as_measured = _is_unfit(judge(last.calibration, seen[0].calibration, TOLERANCES))
    return Judged(as_measured, _answer(scene, ()), _answer(scene, laws))


def _answer(scene: Scene, laws: Sequence[TypeLaw]) -> Answer:
    steps, reference = _steps(scene.seen, laws), scene.seen[0].calibration
    sound = judge(scene.last.calibration, reference, TOLERANCES, steps=steps)
    taken = [(j, own) for j in sound if (own := j.temperature_correction) is not None]
    moved = judge(scene.moved.calibration, reference, TOLERANCES, steps=steps)
    return Answer(
        by_law=_is_unfit(sound),
        undecided=not _is_unfit(sound) and any(j.verdict == "undecidable" for j in sound),
        covered=tuple(abs(own.corrected) <= own.expanded for _, own in taken),
        shares=tuple(own.expanded / j.tolerance for j, own in taken),
        found=_moved(moved, scene.name) in UNFIT,
        excused=bool(scene.stayed) and _is_excused(scene, laws),
    )


def _is_excused(scene: Scene, laws: Sequence[TypeLaw]) -> bool:
    """Whether a sensor that moved when the room became warmer for good passes in the last session there."""
    *seen, last = scene.stayed
    found = judge(last.calibration, seen[0].calibration, TOLERANCES, steps=_steps(seen, laws))
    return _moved(found, scene.name) not in UNFIT


def _stayed(world: Session, changed: Session, half: int, rng: np.random.Generator) -> tuple[Seen, ...]:
    """``half`` sessions at 20 °C, and one more than that at 35 °C of the changed unit."""
    nothing = np.zeros((2, world.unit.size, 2))
    before = [Unit(world, nothing, 0.0).at(ROOM + rng.normal(0, 1), i, rng) for i in range(half)]
    after = [Unit(changed, nothing, 0.0).at(WARM + rng.normal(0, 1), half + i, rng) for i in range(half + 1)]
    return (*before, *after)


def _steps(seen: Sequence[Seen], laws: Sequence[TypeLaw]) -> Steps:
    first: Calibration = seen[0].calibration
    return temperature_steps(seen, first, (seen[0].celsius, WARM), TOLERANCES, laws)


def _is_unfit(found: Sequence[ParameterJudgement]) -> bool:
    return any(one.verdict in UNFIT for one in found)


def _moved(found: Sequence[ParameterJudgement], name: str) -> str:
    """The verdict on a sensor's bias."""
    return next(one.verdict for one in found if (one.sensor, one.parameter) == (name, "bias"))


Answers = dict[tuple[str, int], list[Judged]]


def rows(answers: Answers) -> Iterator[tuple[str, ...]]:
    """Rows of the table."""
    for (kind, learned), units in answers.items():
        as_measured = str(rate([one.as_measured for one in units]))
        for whose, said in (("–", [one.own for one in units]), (str(TYPE_UNITS), [one.typed for one in units])):
            yield kind, str(learned), whose, as_measured, *_row(kind, said)


def _row(kind: str, said: Sequence[Answer]) -> Iterator[str]:
    shares = [share for one in said for share in one.shares]
    yield str(rate([one.by_law for one in said]))
    yield str(rate([one.undecided for one in said]))
    yield str(rate([one.found for one in said]))
    yield str(rate([mark for one in said for mark in one.covered])) if shares else "–"
    yield f"{np.median(shares):.2f} T" if shares else "–"
    yield str(rate([one.excused for one in said])) if kind == NONE else "–"


COLUMNS = (
    "law", "sessions before", "units of the type", "unfit as measured", "unfit by the law", "undecided by it",
    "150 µg moved, found by it", "U covers", "median U", "moved with the room, excused",
)  # fmt: skip


def without_interval(cell: str) -> str:
    """A share without its interval, and without its number where that is not small."""
    found = re.fullmatch(r"(.*) \(.*\) of (\d+)", cell)
    return cell if found is None else found[1] if int(found[2]) >= FEW else f"{found[1]} of {found[2]}"


def paired(own: Sequence[str], typed: Sequence[str]) -> list[str]:
    """One row of both: by the unit's own sessions / with the laws of its type."""
    law, before, _, measured, *rest = own
    both = (f"{without_interval(a)} / {without_interval(b)}" for a, b in zip(rest, typed[4:], strict=True))
    return [law, before, without_interval(measured), *both]


def section(answers: Answers, command: str) -> str:
    """Markdown."""
    whole = list(rows(answers))
    short = [paired(own, typed) for own, typed in zip(whole[::2], whole[1::2], strict=True)]
    return (
        f"{HEADING}\n\nMade by `{command}`. The reference is measured at {ROOM:.0f} °C, the other sessions before "
        f"between {COLDEST:.0f} and {WARMEST:.0f} °C, the judged one at {WARM:.0f} °C; nothing but temperature has "
        "changed. Without a law, or with fewer than six sessions before, a unit is judged as measured, with its "
        f"reservation. *Units of the type*: with the laws of a type, learned from {TYPE_UNITS} other units with "
        f"{TYPE_SESSIONS} sessions each, which do with four sessions before. "
        f"*{LOOSE.capitalize()}*: a fifth of a parabola's bend, sensors {LAG:g} °C (one sigma) off the stated "
        "temperature. U is that of the corrected change. *Moved with the room*: a bias moves by 150 µg when the "
        f"room becomes 15 °C warmer for good. Here by the unit's own sessions / with the laws of the type, "
        f"shares of {FEW} or more unless stated:\n\n"
        f"{table((*COLUMNS[:2], *COLUMNS[3:]), short)}\n\n{in_full(table(COLUMNS, whole))}\n"
    )


def with_section(text: str, own: str = "") -> str:
    """A page with a section, or with the one that stands on the page as it is."""
    own = own or "".join(published(PAGE).partition(HEADING)[1:])
    return f"{text.partition(HEADING)[0].rstrip()}\n" + (f"\n{own.rstrip()}\n" if own else "")


def main() -> None:
    """Run it and write its section."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.temperature_law", description=__doc__)
    parser.add_argument("--units", type=int, default=40)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    with ProcessPoolExecutor(options.processes, mp_context=get_context("spawn")) as pool:
        kinds = tuple(dict.fromkeys(kind for kind, _ in CASES))
        laws = dict(zip(kinds, pool.map(partial(learned_laws, seed=options.seed), kinds), strict=True))
        answers = {
            case: list(
                pool.map(partial(judged, *case, laws[case[0]]), [(options.seed, i, k) for k in range(options.units)])
            )
            for i, case in enumerate(CASES)
        }
    text = section(answers, f"python -m benchmarks.temperature_law --units {options.units} --seed {options.seed}")
    publish(with_section(published(PAGE), text), PAGE)
    print(f"\n{text}")


if __name__ == "__main__":
    main()
