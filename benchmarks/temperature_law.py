"""``python -m benchmarks.temperature_law --units 40 --seed 1`` writes a section of docs/diagnosis/temperature.md.

Units with a reference at 20 °C, seven sessions at other temperatures and one at 35 °C, judged as measured and by the
law that the sessions before it tell.
"""

import argparse
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from datetime import date, timedelta
from functools import partial
from multiprocessing import get_context
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import publish, published
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import calibrate, read_session
from estimator.applied_vector import STANDARD_GRAVITY
from estimator.health import ParameterJudgement, judge
from estimator.health.temperature_law import Seen, Steps, temperature_steps
from estimator.results import ARCSEC, Calibration
from estimator.session import ACCELEROMETER, Array
from tests.blind.warmth import at_temperature, draw_law, draw_unit_at_room, stepped
from tests.blind.world import Session

PAGE = Path(__file__).parents[1] / "docs" / "diagnosis" / "temperature.md"
HEADING = "## A session judged at its reference's temperature"
NONE, LINE, PARABOLA, LOOSE = "none", "line", "parabola", "line with a small bend and lag"
CASES = ((LINE, 8), (PARABOLA, 8), (LOOSE, 8), (LOOSE, 16), (NONE, 8))
"""Law, and sessions before, the reference among them."""
TOLERANCES = {
    (ACCELEROMETER, "bias"): 50e-6 * STANDARD_GRAVITY,
    (ACCELEROMETER, "scale"): 100e-6,
    (ACCELEROMETER, "axis"): 20 * ARCSEC,
}
"""Those that hold until an engineer sets others."""
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


@dataclass(frozen=True)
class Judged:
    """One unit at `WARM`."""

    as_measured: bool
    """Whether it was called unfit without the law."""
    by_law: bool
    """The same at the reference's temperature."""
    undecided: bool
    """Whether it was neither fit nor unfit then."""
    taken: int
    """Parameters that something was taken off of."""
    covered: tuple[bool, ...]
    """Of each of them, whether U covers what is left: nothing moved."""
    shares: tuple[float, ...]
    """Of each of them, U in tolerances."""
    found: bool
    """Whether a sensor whose bias has moved by 150 µg is called unfit by the law, for its bias."""
    excused: bool
    """Whether it passes, having moved when the room became warmer for good."""


def law_of(kind: str, rng: np.random.Generator) -> Array:
    """(2, 4, 2) as `draw_law` has it."""
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


def judged(kind: str, learned: int, seed: tuple[int, ...]) -> Judged:
    """A unit of one kind of law, after so many sessions."""
    rng = np.random.default_rng(seed)
    world, law = draw_unit_at_room(rng), law_of(kind, rng)
    unit = Unit(world, law, LAG if kind == LOOSE else 0.0)
    warm = (ROOM, *rng.uniform(COLDEST, WARMEST, learned - 1))
    seen = [unit.at(float(t), i, rng) for i, t in enumerate(warm)]
    last = unit.at(WARM, learned, rng).calibration
    changed, name = stepped(world, rng)
    moved = Unit(changed, law, unit.lag).at(WARM, learned, rng)
    steps, reference = _steps(seen), seen[0].calibration
    sound = judge(last, reference, TOLERANCES, steps=steps)
    taken = [(j, own) for j in sound if (own := j.temperature_correction) is not None]
    return Judged(
        as_measured=_is_unfit(judge(last, reference, TOLERANCES)),
        by_law=_is_unfit(sound),
        undecided=not _is_unfit(sound) and any(j.verdict == "undecidable" for j in sound),
        taken=len(taken),
        covered=tuple(abs(own.corrected) <= own.expanded for _, own in taken),
        shares=tuple(own.expanded / j.tolerance for j, own in taken),
        found=_moved(judge(moved.calibration, reference, TOLERANCES, steps=steps), name) in UNFIT,
        excused=kind == NONE and _is_excused(world, changed, (name, learned // 2), rng),
    )


def _is_excused(world: Session, changed: Session, of: tuple[str, int], rng: np.random.Generator) -> bool:
    """Whether a sensor that moved when the room became warmer for good passes in the last session there; ``of``: its
    name, and how many sessions came before that."""
    nothing, (name, half) = np.zeros((2, world.unit.size, 2)), of
    before = [Unit(world, nothing, 0.0).at(ROOM + rng.normal(0, 1), i, rng) for i in range(half)]
    after = [Unit(changed, nothing, 0.0).at(WARM + rng.normal(0, 1), half + i, rng) for i in range(half + 1)]
    seen, last = [*before, *after[:-1]], after[-1]
    return _moved(judge(last.calibration, seen[0].calibration, TOLERANCES, steps=_steps(seen)), name) not in UNFIT


def _steps(seen: Sequence[Seen]) -> Steps:
    first: Calibration = seen[0].calibration
    return temperature_steps(seen, first, (seen[0].celsius, WARM), TOLERANCES)


def _is_unfit(found: Sequence[ParameterJudgement]) -> bool:
    return any(one.verdict in UNFIT for one in found)


def _moved(found: Sequence[ParameterJudgement], name: str) -> str:
    """The verdict on a sensor's bias."""
    return next(one.verdict for one in found if (one.sensor, one.parameter) == (name, "bias"))


Answers = dict[tuple[str, int], list[Judged]]


def rows(answers: Answers) -> Iterator[tuple[str, ...]]:
    """Of the table."""
    for (kind, learned), units in answers.items():
        shares = [share for one in units for share in one.shares]
        yield (
            kind,
            str(learned),
            str(rate([one.as_measured for one in units])),
            str(rate([one.by_law for one in units])),
            str(rate([one.undecided for one in units])),
            str(rate([one.found for one in units])),
            str(rate([mark for one in units for mark in one.covered])),
            f"{np.median(shares):.2f} T" if shares else "–",
            str(rate([one.excused for one in units])) if kind == NONE else "–",
        )


COLUMNS = (
    "law", "sessions before", "unfit as measured", "unfit by the law", "undecided by it", "150 µg moved, found by it",
    "U covers", "median U", "moved with the room, excused",
)  # fmt: skip


def section(answers: Answers, command: str) -> str:
    """Markdown."""
    return (
        f"{HEADING}\n\nMade by `{command}`. The reference is measured at {ROOM:.0f} °C, the other sessions before "
        f"between {COLDEST:.0f} and {WARMEST:.0f} °C, the judged one at {WARM:.0f} °C; nothing but temperature has "
        "changed. Without a law, or with fewer than six sessions before, a unit is judged as measured, with its "
        f"reservation. *{LOOSE.capitalize()}*: a fifth of a parabola's bend, sensors {LAG:g} °C (one sigma) off the "
        "stated temperature. U is that of the corrected change. *Moved with the room*: a bias moves by 150 µg when the "
        "room becomes 15 °C warmer for good.\n\n"
        f"{table(COLUMNS, rows(answers))}\n"
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
        answers = {
            case: list(pool.map(partial(judged, *case), [(options.seed, i, k) for k in range(options.units)]))
            for i, case in enumerate(CASES)
        }
    text = section(answers, f"python -m benchmarks.temperature_law --units {options.units} --seed {options.seed}")
    publish(with_section(published(PAGE), text), PAGE)
    print(f"\n{text}")


if __name__ == "__main__":
    main()
