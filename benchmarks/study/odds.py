"""``python -m benchmarks.study.odds --sessions 300 --seed 1`` tells how likely something may be held to act.

Sound sessions of the blind generator, which has physics of its own, are weighed as they are. For prior odds that some
cause acts it counts the sessions in which one place would be named. `priors.SOMETHING` may be as large as leaves at
most one in a hundred.
"""

import argparse
import math
import os
import sys
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from benchmarks.details import RESULTS
from benchmarks.study.rates import rate
from benchmarks.study.report import table
from estimator import read_session
from estimator.causes.catalogue import CATALOGUE
from estimator.causes.contract import Signature
from estimator.diagnosis.diagnose import initial_state, put_right
from estimator.diagnosis.posterior.explained import restart_from
from estimator.diagnosis.posterior.noise import of_quiet_sensors
from estimator.diagnosis.posterior.priors import SOMETHING
from estimator.diagnosis.posterior.solve import SessionTerms
from tests.blind.cases import draw_case

TRIED = (0.3, 1.0, 3.0, 10.0, 30.0)
"""Prior odds that some cause acts."""

KNOWN = [cause for cause in CATALOGUE if isinstance(cause, Signature)]


def likeliest(seed: tuple[int, int]) -> float:
    """ln posterior odds, against nothing, of the likeliest cause of a sound session."""
    case = draw_case("none", seed, None)
    whole = put_right(read_session(case.session), [read_session(file) for file in case.history], CATALOGUE)
    state = initial_state(whole.right, whole.earlier, CATALOGUE)
    model = SessionTerms.of_causes(restart_from(state, of_quiet_sensors(state.baseline)).residuals, KNOWN).model
    return max(candidate.value for candidate in model.beside(()).candidates(model.of_causes))


def page(odds: list[float], command: str) -> str:
    """Markdown."""
    rows = [(f"{tried:g}", rate([one + math.log(tried / SOMETHING) > 0 for one in odds])) for tried in TRIED]
    lines = table(("odds that some cause acts", "sound sessions with a name"), rows)
    title = "# Odds that something acts"
    text = (
        f"{len(odds)} sound sessions, made by `{command}`. The diagnosis takes {SOMETHING:g}. Intervals: 95 % (Wilson)."
    )
    return f"{title}\n\n{text}\n\n{lines}\n"


def main(arguments: list[str]) -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.study.odds", description=__doc__)
    parser.add_argument("--sessions", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args(arguments)
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        odds = list(pool.map(likeliest, [(asked.seed, k) for k in range(asked.sessions)], chunksize=4))
    text = page(odds, f"python -m benchmarks.study.odds --sessions {asked.sessions} --seed {asked.seed}")
    (RESULTS / "diagnosis" / "odds.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main(sys.argv[1:])
