"""Naming may not predict worse: every name of a group is tried on sessions that took no part in its amplitude.

Of three parts of the sessions each is predicted from the other two, with the amplitude, its covariance and the spread
between sessions that those have. A name whose sessions are likelier without it is none.
"""

from dataclasses import replace

import numpy as np

from estimator.groups.random_effects import mean_of
from estimator.groups.selection import Found, Selection
from estimator.groups.terms import predictive

PARTS = 3
"""Of the sessions, every third one in each: all reach over the whole life of the group."""


def names_that_predict(state: Selection) -> Selection:
    """The findings by which sessions left out are likelier; the others are not tried again."""
    worse = tuple(f for f in state.found if gained(state, f) <= 0)
    found = tuple(f for f in state.found if f not in worse)
    return replace(state, found=found, barred=state.barred | {f.hypothesis.group for f in worse})


def gained(state: Selection, name: Found) -> float:
    """Log predictive density that a name gains, the other findings given."""
    w, k = name.place
    moments = state.weighed(without=name).pool.moments[w]
    U, F = moments.U[name.since :, k], moments.F[name.since :, k]
    seen = np.diagonal(F, axis1=1, axis2=2).sum(axis=1) > 0
    U, F = U[seen], F[seen]
    part = np.arange(len(U)) % PARTS
    whole = 0.0
    for p in range(PARTS) if len(U) > 1 else ():
        fit = part != p
        mean = mean_of(U[fit], F[fit])
        spread = mean.covariance + mean.spread**2 * np.eye(w)
        whole += sum(predictive(mean.value, spread, u, f) for u, f in zip(U[~fit], F[~fit], strict=True))
    return whole if len(U) > 1 else np.inf
