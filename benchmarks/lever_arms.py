"""``python -m benchmarks.lever_arms`` prints what lever arms do to an alignment, and how often one is named wrongly."""

from dataclasses import replace

import numpy as np

from estimator.alignment.align import prepared
from estimator.alignment.lever_arms import LEVEL, lever_arms
from estimator.alignment.simulate import TurntableProgramme
from estimator.applied_vector import STANDARD_GRAVITY
from estimator.results import ARCSEC
from tests.estimator.alignment.cases import aligned, drawn
from tests.estimator.alignment.exact import Run, turned

RATES, ARMS = (2.0, 6.0, 20.0), (0.05, 0.1, 0.3)
"""°/s and m."""
SESSIONS = 1500
"""Sound ones."""
SEED = 77
"""Seed of the rates and leans."""
STOPS = ((0.0, 180.0), (0.0, 180.0, 0.0), (0.0, 90.0, 180.0, 270.0))
"""degrees."""


def harm() -> None:
    """Errors of ∇ and E where lever arms are taken for nothing, and with them in the state."""
    print("°/s  r, cm  state     ∇, µg    E, ″   χ²")
    for rate in RATES:
        for arm in ARMS:
            away = np.zeros((6, 3))
            away[0, 0], away[1, :2] = arm, (0.3 * arm, -arm)
            truth = replace(drawn(np.random.default_rng(3)), positions=away)
            programme = TurntableProgramme(dwell=200.0, ramp=1.0, rate=np.radians(rate))
            for known in (False, True):
                case = aligned(truth, programme=programme, lever_arms=known)
                zero, mounting = np.abs(case.error[6:8]).max(), np.abs(case.error[8:10]).max()
                fit = case.result.fit
                print(
                    f"{rate:3.0f}  {100 * arm:5.0f}  {'with' if known else 'without':8}"
                    f"{zero / STANDARD_GRAVITY * 1e6:7.1f} {mounting / ARCSEC:7.2f} {fit.chi2 / fit.dof:8.2f}"
                )


def false_names() -> None:
    """Sound sessions in which a lever arm is named, or anything else said to be there."""
    rng, named, other = np.random.default_rng(SEED), 0, 0
    for number in range(SESSIONS):
        run = Run(
            dwell=40.0,
            row=0.5,
            rates=(float(rng.uniform(2, 20)),),
            lean=tuple(5e-4 * rng.standard_normal(2)),
            stops=STOPS[number % len(STOPS)],
            rough=(1.0, 3.0)[number % 2],
            wobble=(0.5, 2.0)[number % 2],
        )
        arms = lever_arms(prepared(turned(run, 1000 + number))).estimates
        named += any(arm.named for arm in arms)
        other += any(arm.other or arm.more < LEVEL / len(arms) for arm in arms)
    print(f"of {SESSIONS} sound sessions: a lever arm named in {named}, something else said in {other}")


if __name__ == "__main__":
    harm()
    false_names()
