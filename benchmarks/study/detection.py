"""``python -m benchmarks.study.detection --sessions 84 --sound 400 --seed 2`` writes what is found beside rivals.

How faint an effect may be and still be found, by the diagnosis and by its rivals, on the same sessions and at equal
false alarms: every rival's threshold is the one that 1 % of the same sound sessions pass, or as many as get a name.
What was looked at is kept in build/study, and a study that was stopped goes on from there: remove it after a change of
the program. The section on a network stays as it is where no network is given.

Theory
------
Let a shape with q amplitudes explain T of the residual's energy, χ² with q degrees of freedom where nothing acts. Of
an effect whose strength is s and whose direction nobody knows, the likelihood ratio averaged over directions is

    Λ(T; s) = exp(−s²/2) ₀F₁(; q/2; s²T/4)

and its mean over the generator's own prior (causes alike, the places and shapes of each alike) is the most powerful
test there is on average over that prior (Neyman and Pearson): no method that is not given the cause can find more.
"""

import argparse
import json
import math
import os
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Protocol

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from scipy.special import gammaln, ive, logsumexp

from benchmarks.details import RESULTS
from benchmarks.study.kept import BUILD
from benchmarks.study.neural.network import Answer, answer, weights
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from benchmarks.study.signatures import Signatures, SignatureScores
from estimator import diagnose, read_session
from estimator.causes.catalogue import CATALOGUE as KNOWN
from estimator.diagnosis.diagnose import initial_state, put_right
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array
from tests.blind.case import Case
from tests.blind.cases import draw_at, draw_case
from tests.blind.catalogue import CATALOGUE, DISCRETE, HISTORY
from tests.blind.hide import UnhideableError
from tests.blind.score import score

PAGE = RESULTS / "diagnosis" / "detection.md"
STRENGTHS = (4.0, 5.0, 6.0, 8.0)
ALARMS = 0.01
NONLINEAR = ("saturation", "excess-noise")
"""They add no shape of a free size."""
HIDDEN = tuple(c for c, h in CATALOGUE.items() if c not in DISCRETE | {*NONLINEAR} and h.scope != HISTORY)
NEVER = -1e3
"""ln likelihood ratio of what a session cannot show."""
CUTS = np.geomspace(0.02, 8.0, 80)
"""Thresholds tried, in standard errors: terms that resemble one another share an effect, so that each is small."""
RIDGE = 0.05
"""Ridge of the sparse regression, as PySINDy's default."""


@dataclass(frozen=True)
class Task:
    """One session to look at; without a strength it is sound."""

    seed: tuple[int, ...]
    strength: float = 0.0
    cause: str = ""


@dataclass(frozen=True)
class Look:
    """Figures of each method for one session: the larger, the surer that something acts."""

    cause: str
    strength: float
    named: bool
    """The diagnosis gives a name."""
    listed: bool
    """The right one, first or among the alternatives."""
    families: dict[str, float]
    """−ln p of the family of each cause: a matched subspace that is given the cause, not the sensor."""
    whole: float
    """−ln p of the whole catalogue, Bonferroni."""
    limit: dict[float, float]
    """ln Λ under the generator's prior, for each strength."""
    sparse: float
    """Largest threshold at which sequentially thresholded least squares keeps a term."""
    energy: float
    """−ln p of the residuals' χ²: no shape is looked for."""
    neural: Answer | None = None
    """Answer of a network, where one is given."""


def tasks(sessions: int, sound: int, seed: int) -> Iterator[Task]:
    """Every strength with the causes in turn, and the sound sessions."""
    for strength in STRENGTHS:
        yield from (Task((seed, int(strength), k), strength, HIDDEN[k % len(HIDDEN)]) for k in range(sessions))
    yield from (Task((seed, 0, k)) for k in range(sound))


def drawn(task: Task) -> Case:
    """The session, without others of its unit."""
    return draw_at(task.strength, task.seed, task.cause) if task.cause else draw_case("none", task.seed)


def perform(task: Task, network: Path | None = None) -> Look | None:
    """Draws a session, diagnoses it and compares; None where no session drawn can hold the effect."""
    try:
        case = drawn(task)
    except UnhideableError:
        return None
    session = read_session(case.session)
    state = initial_state(put_right(session, (), KNOWN).right, (), KNOWN)
    found = diagnose(session).to_dict()
    known = Signatures.of(state)
    seen = known.scores(state.attributed())
    p_values = family_p_values(known, seen)
    return Look(
        task.cause,
        task.strength,
        bool(found["findings"]),
        bool(case.truths) and score(case, found, 0.0).listed,
        {cause: -float(np.log(p)) for cause, p in p_values.items()},
        -float(np.log(min(p_values.values(), default=1.0) * known.families)),
        {s: likelihood_ratio(known, seen, s) for s in STRENGTHS},
        sparse_threshold(known),
        energy(state.residuals),
        answer(network, state.residuals) if network else None,
    )


def family_p_values(known: Signatures, seen: SignatureScores) -> dict[str, float]:
    """Family-wise p-value of each cause: the least p-value of its shapes, times their number."""
    least = {c: float(seen.p_value[seen.cause == c].min(initial=1.0)) for c in known.places}
    return {c: max(min(p * known.places[c], 1.0), 1e-300) for c, p in least.items()}


def likelihood_ratio(known: Signatures, seen: SignatureScores, strength: float) -> float:
    """ln Λ averaged over causes, and over the shapes of each."""
    ratio = log_likelihood_ratio(seen.statistic, seen.freedom, strength)
    each = [float(logsumexp(ratio[seen.cause == c])) - np.log(n) for c, n in known.places.items()]
    return float(logsumexp(each)) - np.log(len(each)) if each else NEVER


def log_likelihood_ratio(statistic: Array, freedom: Array, strength: float) -> Array:
    """(k,) ln Λ(T; s); NEVER where a shape has no amplitude."""
    x, order = strength * np.sqrt(np.maximum(statistic, 1e-12)), np.maximum(freedom, 1) / 2 - 1
    bessel = np.log(ive(order, x)) + x
    return np.where(freedom > 0, gammaln(order + 1) + order * np.log(2 / x) + bessel - strength**2 / 2, NEVER)


def sparse_threshold(known: Signatures) -> float:
    """Sequentially thresholded least squares (Brunton et al. 2016, appendix B) over all shapes at once."""
    library = known.library
    norms = np.linalg.norm(library, axis=0)
    library = library[:, norms > 0] / norms[norms > 0]
    return max((cut for cut in CUTS if _kept(library, known.residuals.z, cut)), default=0.0)


def _kept(library: Array, z: Array, cut: float) -> bool:
    """Whether a term remains at a threshold, in standard errors."""
    chosen = np.arange(library.shape[1])
    while len(chosen):
        some = library[:, chosen]
        value = some.T @ np.linalg.solve(some @ some.T + RIDGE * np.eye(len(z)), z)
        keep = np.abs(value) >= cut
        if keep.all():
            return True
        chosen = chosen[keep]
    return False


def energy(residuals: WhitenedResiduals) -> float:
    """Excess of the residuals' χ² over its mean, in standard deviations."""
    z, freedom = residuals.z, float(residuals.row_freedom.sum())
    return float((z @ z - freedom) / np.sqrt(2 * freedom))


class Method(Protocol):
    """Figure of a method for a session, where effects have a strength."""

    def __call__(self, look: Look, strength: float) -> float: ...


METHODS: tuple[tuple[str, Method], ...] = (
    ("exhaustive Bayes with the generator's prior: the limit", lambda look, strength: look.limit[strength]),
    ("matched subspaces of the whole catalogue", lambda look, strength: look.whole),
    (
        "parity space: likelihood ratio of one step of one sensor",
        lambda look, strength: look.families.get("bias-jump", 0.0),
    ),
    ("sparse regression (STLSQ) over all shapes", lambda look, strength: look.sparse),
    ("χ² of the residuals", lambda look, strength: look.energy),
)


NEURAL = "neural posterior, learned from simulated sessions"
NETWORK = "\n## A network beside them\n"
HEAD = ("method", "sound sessions", *(f"strength {s:g}" for s in STRENGTHS))
Sessions = dict[float, list[Look]]
"""Sessions with an effect, by its strength."""


def divided(looks: list[Look]) -> tuple[list[Look], Sessions]:
    """Sound sessions, and those with an effect."""
    sound = [look for look in looks if not look.cause]
    return sound, {s: [look for look in looks if look.cause and look.strength == s] for s in STRENGTHS}


def page(looks: list[Look], command: str) -> str:
    """Markdown."""
    sound, hidden = divided(looks)
    named = rate([k.named for k in sound])
    ours = [
        ("the diagnosis: any name", named, *(rate([k.named for k in h]) for h in hidden.values())),
        ("the diagnosis: the right name, first or listed", "", *(rate([k.listed for k in h]) for h in hidden.values())),
    ]
    return (
        f"# How faint an effect is still found\n\n{len(looks)} simulated sessions, made by `{command}`. "
        "Every method sees the same sessions; each rival has the threshold that 1 % of the same sound sessions pass. "
        "Strength: see [the study](../../../docs/diagnosis/study.md). Intervals: 95 % (Wilson).\n\n"
        f"{table(HEAD, [*ours, *rivals(sound, hidden, ALARMS)])}\n\n"
        "The last line is given the cause that acts, so that it looks for one family of shapes where all others look "
        f"for {len(HIDDEN)}: what lies between it and the limit is the price of not knowing the cause, which nobody "
        "who measures can avoid. What the diagnosis lacks to the limit is the price of what this generator never does: "
        "errors with tails and effects that no catalogue has, beside which a faint name must hold; the "
        "limit also knows how strong and how frequent every cause is drawn.\n\n"
        "## At the false alarms of the diagnosis\n\n"
        "Each rival has the threshold that as many of the sound sessions pass as get a name.\n\n"
        f"{table(HEAD, [*ours[:1], *rivals(sound, hidden, named.share)])}\n"
    )


def rivals(sound: list[Look], hidden: Sessions, alarms: float) -> list[tuple[object, ...]]:
    """Lines of the other methods at equal false alarms."""
    said = f"{100 * alarms:.2g} %"
    rows: list[tuple[object, ...]] = []
    for name, method in METHODS:
        found = [_passed(sound, h, partial(method, strength=s), alarms) for s, h in hidden.items()]
        rows.append((name, said, *found))
    given = [_given(sound, h, alarms) for h in hidden.values()]
    return [*rows, ("matched subspace that is *given the cause*", said, *given)]


def beside_network(looks: list[Look], command: str, network: Path) -> str:
    """A section: what a network finds, how it learned."""
    sound, hidden = divided(looks)
    had, limit, log_odds = weights(network), METHODS[0], lambda look: look.neural.log_odds
    rows: list[tuple[object, ...]] = [
        (limit[0], "1 %", *(_passed(sound, h, partial(limit[1], strength=s)) for s, h in hidden.items())),
        (NEURAL, "1 %", *(_passed(sound, h, log_odds) for h in hidden.values())),
        (f"{NEURAL}: the right name first", "", *(_passed(sound, h, log_odds, right=True) for h in hidden.values())),
    ]
    return (
        f"{NETWORK}\n{len(looks)} simulated sessions, made by `{command}`.\n\n{table(HEAD, rows)}\n\n"
        "The neural posterior learns signatures of its own, from attitude, time and temperature of the readings: "
        f"{had['minutes']:.0f} minutes ({had['processor_minutes']:.0f} of one processor), {had['sessions']} sessions, "
        f"{had['draws'] / 1e6:.1f} million draws; log loss of held-out sessions {had['loss']:.2f}, of the prior "
        f"{had['prior_loss']:.2f} (`python -m benchmarks.study.neural`). Without the catalogue it finds most of what "
        "the diagnosis finds and names fewer causes right: learned signatures blur steps, kinks and causes that "
        "resemble one another.\n"
    )


def threshold(values: list[float], alarms: float) -> float:
    """Value that so large a share of the values, of sound sessions, exceeds."""
    return [-math.inf, *sorted(values)][-1 - round(alarms * len(values))]


def _passed(
    sound: list[Look],
    hidden: list[Look],
    statistic: Callable[[Look], float],
    alarms: float = ALARMS,
    *,
    right: bool = False,
) -> str:
    """Share above the threshold; ``right``: with the right cause, as the network names it."""
    above = threshold([statistic(look) for look in sound], alarms)
    return str(rate([statistic(k) > above and (not right or k.neural.cause == k.cause) for k in hidden]))


def _given(sound: list[Look], hidden: list[Look], alarms: float) -> str:
    """The threshold is of all causes' families in all sound sessions: each is given one of them."""
    above = threshold([value for look in sound for value in look.families.values()], alarms)
    return str(rate([look.families.get(look.cause, 0.0) > above for look in hidden]))


def resumed(work: list[Task], processes: int, network: Path | None, path: Path) -> Iterator[Look | None]:
    """The looks of all tasks in order: those that the file holds first, then the others, each written as it comes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    before = path.read_text().splitlines(keepends=True)[: len(work)] if path.exists() else []
    before = [line for line in before if line.endswith("\n")]
    yield from map(_look, before)
    with path.open("w") as file, ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        file.writelines(before)
        for k, look in enumerate(pool.map(partial(perform, network=network), work[len(before) :], chunksize=2), 1):
            file.write(json.dumps(look and asdict(look)) + "\n")
            file.flush()
            print(f"\r{len(before) + k}/{len(work)}", end="", file=sys.stderr)
            yield look
    print(file=sys.stderr)


def _look(line: str) -> Look | None:
    values = json.loads(line)
    if values is None:
        return None
    limit = {float(strength): value for strength, value in values["limit"].items()}
    neural = values["neural"] and Answer(*values["neural"])
    return Look(**values | {"limit": limit, "neural": neural})


def main() -> None:
    """Look at all sessions and write the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.detection", description=__doc__)
    parser.add_argument("--sessions", type=int, default=84, help="of each strength")
    parser.add_argument("--sound", type=int, default=400)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--network", type=Path, help="weights that `python -m benchmarks.study.neural` wrote")
    parser.add_argument("--out", type=Path, default=PAGE)
    options = parser.parse_args()
    given = f"--sessions {options.sessions} --sound {options.sound} --seed {options.seed}"
    kept = BUILD / "study" / f"detection-{options.sessions}-{options.sound}-{options.seed}.jsonl"
    if options.network:
        given, kept = f"{given} --network {options.network}", kept.with_suffix(".network.jsonl")
    work = list(tasks(options.sessions, options.sound, options.seed))
    looks = [look for look in resumed(work, options.processes, options.network, kept) if look]
    command = f"python -m benchmarks.study.detection {given}"
    before = options.out.read_text(encoding="utf-8") if options.out.exists() else ""
    section = (
        beside_network(looks, command, options.network) if options.network else "".join(before.partition(NETWORK)[1:])
    )
    text = page(looks, command) + section
    options.out.write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
