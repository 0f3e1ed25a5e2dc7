"""``python -m benchmarks.study.turns --sessions 6 --seed 1``: what turned blocks are taken for."""

import argparse
import os
from collections.abc import Callable, Iterable
from dataclasses import dataclass

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.details import in_full
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from benchmarks.study.turned_pairs import PROGRAMMES, Pair, Programme, Wish, draw_flipped, draw_pair
from estimator import calibrate, diagnose, read_session
from service.judging.judge import judge
from service.sessions.decision import Verdict
from service.types.records import UnitType
from service.types.rules import ACCELEROMETER_DEFAULTS, GYROSCOPE_DEFAULTS

DEGREES = (0.01, 0.1, 0.5, 1.0, 2.0, 5.0)
DRIFT_DEGREES = (0.0, 1.0, 5.0)
"""Turns of pairs with a drift, degrees: none, to see what the drift alone is called."""
STRENGTH = 12.0
NAMES = tuple(programme.name for programme in PROGRAMMES)
BAD = (Verdict.FAIL, Verdict.CONDITIONAL_FAIL)


@dataclass(frozen=True)
class Turned:
    """The answers to one pair."""

    wish: Wish
    drifts: tuple[str, ...]
    """Sensors with a drift by name."""
    listed: tuple[str, ...]
    """Sensors of which a drift is an alternative to the name that they have."""
    others: tuple[str, ...]
    """Names beside a turn of the block and drifts."""
    judged: tuple[str, ...]
    """Sensors out of tolerance, or left out of the common motion."""
    verdict: Verdict
    remount: bool
    inside: tuple[bool, ...]
    """Whether each component of the turn lies within two of its sigmas."""
    drifted: str | None


def examine(wish: Wish, seed: tuple[int, ...]) -> Turned:
    """One pair drawn, diagnosed and judged."""
    pair = draw_pair(wish, np.random.default_rng(seed))
    session, history = read_session(pair.session), [read_session(h) for h in pair.history]
    found = diagnose(session, history=history)
    judged, verdict = moved(pair)
    turn = [f for f in found.findings if f.cause == "remount-rotation"]
    drifts = [s for f in found.findings if f.cause == "sensor-drift" for s in f.sensors]
    others = [f.cause for f in found.findings if f.cause not in ("remount-rotation", "sensor-drift")]
    pulls = [(np.array(f.amplitude) - pair.turn) / f.sigma for f in turn]
    inside = tuple(bool(abs(p) <= 2) for pull in pulls for p in pull)
    listed = [s for f in found.findings if "sensor-drift" in f.alternatives for s in f.sensors]
    return Turned(
        wish=wish,
        drifts=tuple(drifts),
        listed=tuple(listed),
        others=tuple(others),
        judged=judged,
        verdict=verdict,
        remount=bool(turn),
        inside=inside,
        drifted=pair.drifted,
    )


def moved(pair: Pair) -> tuple[tuple[str, ...], Verdict]:
    """The sensors that the service's rule says moved, against the latest session before, and its verdict."""
    now, then = (calibrate(read_session(document)) for document in (pair.session, pair.history[-1]))
    kind = now.sensors[0].kind
    own = ACCELEROMETER_DEFAULTS if kind == "accelerometer" else GYROSCOPE_DEFAULTS
    found = judge(now, then, UnitType("drawn", kind, (), (), (), own, None, 1), 2.0)
    out = {d.sensor for d in found.decisions if d.verdict in BAD}
    out |= {sensor for motion in found.motions for sensor in motion.left_out}
    return tuple(sorted(out)), found.verdict


@dataclass(frozen=True)
class Flipped:
    """The answer to one session whose block sat turned in its flipped run."""

    programme: str
    degrees: float
    named: bool
    others: tuple[str, ...]
    """Names beside it, and ``unexplained`` where structure was left."""
    inside: tuple[bool, ...]


def examine_flipped(programme: Programme, degrees: float, seed: tuple[int, ...]) -> Flipped:
    """One session drawn and diagnosed."""
    pair = draw_flipped(programme, degrees, np.random.default_rng(seed))
    found = diagnose(read_session(pair.session))
    own = [f for f in found.findings if f.cause == "flip-misalignment"]
    others = [f.cause for f in found.findings if f not in own] + ["unexplained"] * bool(found.structures)
    inside = [abs(p) <= 2 for f in own for p in (np.array(f.amplitude) - pair.turn) / f.sigma]
    return Flipped(programme.name, degrees, bool(own), tuple(others), tuple(map(bool, inside)))


def run_flipped(sessions: int, seed: int) -> list[Flipped]:
    """Every programme on a stand, turned in its flipped run."""
    stands = [p for p in PROGRAMMES if p.stand]
    cases = [(p, d) for p in stands for d in DEGREES]
    return [examine_flipped(p, d, (seed, 1, i, k)) for i, (p, d) in enumerate(cases) for k in range(sessions)]


def flipped_page(found: list[Flipped]) -> str:
    """Markdown."""
    rows = []
    for degrees in (*DEGREES, None):
        own = [f for f in found if degrees in (None, f.degrees)]
        inside = rate([i for f in own for i in f.inside])
        name = "all" if degrees is None else f"{degrees:g}°"
        rows.append((name, rate([f.named for f in own]), rate([bool(f.others) for f in own]), inside))
    head = ("turn", "`flip-misalignment`", "anything else", "within two sigma")
    return "### The block turned in its flipped run, no history\n\n" + table(head, rows)


def run(sessions: int, seed: int) -> list[Turned]:
    """Every programme and turn: clean pairs, pairs with a drift, and histories of three mountings."""
    wishes = [Wish(p, d) for p in PROGRAMMES for d in DEGREES]
    wishes += [Wish(p, d, drift=STRENGTH) for p in PROGRAMMES for d in DRIFT_DEGREES]
    wishes += [Wish(p, 5.0, earlier=3) for p in PROGRAMMES]
    return [examine(w, (seed, i, k)) for i, w in enumerate(wishes) for k in range(sessions)]


def page(found: list[Turned]) -> str:
    """Markdown, but for the targets."""
    single = [f for f in found if f.wish.earlier == 1]
    clean, drifted = ([f for f in single if (f.wish.drift > 0) == with_drift] for with_drift in (False, True))
    return "\n\n".join(
        [
            "No sensor changed; of a turn the share of its three components within two of their own sigma.",
            _clean(clean, lambda f: f"{f.wish.degrees:g}°", [f"{d:g}°" for d in DEGREES], "turn"),
            _clean(clean, lambda f: f.wish.programme.name, NAMES, "programme"),
            f"### A drift of strength {STRENGTH:g} beside the turn",
            _beside(drifted, lambda f: f"{f.wish.degrees:g}°", [f"{d:g}°" for d in DRIFT_DEGREES], "turn"),
            "### Three sessions before, each in another mounting",
            _clean(
                [f for f in found if f.wish.earlier > 1],
                lambda f: f.wish.programme.name,
                [],
                "programme",
            ),
        ]
    )


def _targets(sound: list[Turned]) -> str:
    """Targets where no sensor changed, for histories of one mounting and of three together."""
    wrong = rate([bool(f.drifts or f.judged) for f in sound])
    row = ("no sensor changed, turned by up to 5°: a drift named or a sensor judged as moved", "≤ 1 %", wrong)
    return table(("figure", "target", "measured"), [row])


def _clean(found: list[Turned], key: Callable[[Turned], str], names: Iterable[str], of: str) -> str:
    rows = []
    for name in (*names, "all"):
        own = [f for f in found if name in ("all", key(f))]
        shown = [f for f in own if f.wish.programme.shows_a_turn]
        rows.append(
            (
                name,
                rate([bool(f.drifts) for f in own]),
                rate([bool(f.others) for f in own]),
                rate([bool(f.judged) for f in own]),
                rate([f.remount for f in shown]),
                rate([i for f in shown for i in f.inside]),
            )
        )
    head = (of, "a drift named", "another name", "a sensor judged as moved", "turn named", "within two sigma")
    return table(head, rows)


def _beside(found: list[Turned], key: Callable[[Turned], str], names: Iterable[str], of: str) -> str:
    rows = []
    for name in (*names, "all"):
        own = [f for f in found if name in ("all", key(f))]
        rows.append(
            (
                name,
                rate([f.drifted in f.drifts for f in own]),
                rate([f.drifted in f.drifts + f.listed for f in own]),
                rate([bool(set(f.drifts) - {f.drifted}) for f in own]),
                rate([bool(set(f.judged) - {f.drifted}) for f in own]),
                rate([i for f in own if f.wish.degrees for i in f.inside]),
            )
        )
    head = (of, "drift named", "or listed", "of a sound sensor", "a sound one judged", "turn within two sigma")
    return table(head, rows)


def tables(sessions: int, seed: int) -> str:
    """All tables in Markdown."""
    found = run(sessions, seed)
    details = in_full(f"{page(found)}\n\n{flipped_page(run_flipped(sessions, seed))}")
    targets = _targets([f for f in found if not f.wish.drift])
    return f"## The block turned between sessions\n\n{targets}\n\n{details}"


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.turns", description=__doc__)
    parser.add_argument("--sessions", type=int, default=6, help="of each programme and turn")
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    print(tables(options.sessions, options.seed))


if __name__ == "__main__":
    main()
