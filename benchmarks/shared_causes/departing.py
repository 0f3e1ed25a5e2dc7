"""Most sensors settle together and a few depart from them: what readings that took no part are worth then."""

from collections.abc import Iterator

import numpy as np

from benchmarks.shared_causes.unlike import Line
from benchmarks.study.rates import rate
from estimator import diagnose, read_session
from estimator.diagnosis.results import Diagnosis
from tests.blind.courses import BLOCKS, draw_departing

BLOCK = BLOCKS[-1]
FOLLOWING, DEPARTING = BLOCK.accelerometers, 4
EACH = 15.0
"""Strength of every sensor, standard errors."""
LIMIT = 1.21
"""Held-out χ²/dof."""
MOST = 2
"""Names beside the course."""
WORSE = 1.1
"""Held-out rms over that without causes from which on a sensor is predicted worse: less is chance."""
KINDS = ("with time constants of their own", "with a quicker course beside it")


def departing(sessions: int, seed: int) -> Iterator[Line]:
    """Lines from so many sessions of either kind."""
    for second, words in enumerate(KINDS):
        found = [_diagnosed((seed, FOLLOWING, DEPARTING, k, second)) for k in range(sessions)]
        head = f"24 sensors settle, {DEPARTING} of them {words}: "
        chi2 = np.array([d.gain.after.chi2_per_dof for d in found])
        held = f"{np.median(chi2):.2f} (worst {chi2.max():.2f})"
        yield head + "held-out χ²/dof, median", f"≤ {LIMIT}", held
        yield head + f"held-out χ²/dof at most {LIMIT}", "", str(rate([c <= LIMIT for c in chi2]))
        yield head + f"one course, at most {MOST} names beside it", "≥ 95 %", str(rate(list(map(_is_one, found))))
        yield head + "a sensor predicted worse than without causes", "", str(rate(list(map(_is_worse, found))))


def _diagnosed(seed: tuple[int, ...]) -> Diagnosis:
    hidden = draw_departing(BLOCK, DEPARTING, EACH, np.random.default_rng(seed), second=bool(seed[-1]))
    return diagnose(read_session(hidden.session))


def _is_one(found: Diagnosis) -> bool:
    shared = [f for f in found.findings if f.shared is not None]
    return len(shared) == 1 and len(found.findings) <= 1 + MOST


def _is_worse(found: Diagnosis) -> bool:
    before, after = found.gain.before.rms_by_sensor, found.gain.after.rms_by_sensor
    return any(after[kind][name] > WORSE * rms for kind, own in before.items() for name, rms in own.items())
