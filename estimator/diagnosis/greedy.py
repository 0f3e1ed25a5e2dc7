"""Causes, and patterns without a name, added one after another until nothing is significant any more.

Before a scatter larger than stated is called excess noise, it is looked at without belief in the stated noise: no
signature and no pattern may stand out of it, and it may not run smoothly along any order of the rows.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import chdtrc

from estimator.diagnosis.evidence import Evidence
from estimator.diagnosis.serial import Serial, serial_structure
from estimator.diagnosis.state import LEVEL, Excess, Found, Search, begin, companions, strongest

DECISIVE = 4.0
"""ln evidence by which a signature must beat mere excess noise to be believed without a look at the scatter."""

DOUBT = 0.05
"""Level at which a scatter that seems too large is taken for uneven rather than for mere noise."""

AGAIN = frozenset({"reading-outlier", "bias-jump"})
"""Causes that may happen to one sensor more than once."""

MOST = 8
"""Different causes (and, apart from them, patterns) looked for in one session, each on as many sensors as show it."""


def causes(state: Search) -> Search:
    """Add causes until none is significant."""
    while len({f.best.cause.identifier for f in state.found}) < MOST:
        noisy = noisiest(state)
        best = strongest(state, state.traces)
        if noisy is not None and (best is None or noisy.evidence > best.ranking[0][1] - DECISIVE):
            wary = with_unknown_noise(state, noisy.sensor)
            best = strongest(wary, wary.traces)
            if best is None and strongest(wary, wary.patterns) is None:
                uneven = serial_of(state, noisy.sensor)
                known = with_excess(state, noisy) if uneven is None else replace(state, serial=(*state.serial, uneven))
                state = known
                continue
        if best is None:
            break
        found = (*state.found, best, *companions(state, best, state.traces))
        if repeated(found):
            break
        state = replace(state, found=found)
    return state


def repeated(found: Sequence[Found]) -> bool:
    """Whether a cause that can act on a sensor only once was named on it twice: then it is not that cause."""
    once = [f.best.group for f in found if f.best.cause.identifier not in AGAIN]
    return len(once) != len(set(once))


def with_unknown_noise(state: Search, sensor: int) -> Search:
    """The search that does not believe one sensor's stated noise: its signatures must stand out of its own scatter."""
    unstated = state.baseline.unstated.copy()
    unstated[sensor] = True
    baseline = replace(state.baseline, unstated=unstated)
    return replace(state, baseline=baseline, evidence=replace(state.evidence, baseline=baseline))


def with_excess(state: Search, noisy: Excess) -> Search:
    """The search begun anew with the noisy sensor's variance as it is, known from its own residuals alone."""
    variance, unstated = state.baseline.variance.copy(), state.baseline.unstated.copy()
    variance[:, noisy.sensor] *= noisy.ratio
    unstated[noisy.sensor] = True
    baseline = replace(state.baseline, variance=variance, unstated=unstated)
    again = begin(baseline, state.history, state.catalogue)
    return causes(replace(again, excess=(*state.excess, noisy), serial=state.serial))


def noisiest(state: Search) -> Excess | None:
    """The sensor whose left-over most exceeds its stated noise; None if none does significantly."""
    evidence = state.evidence
    z, taken = state.left, state.taken()
    owner, m = evidence.owner(), len(evidence.baseline.unstated)
    used = np.zeros(len(z))
    used[: evidence.readings] = (evidence.basis**2).sum(axis=1)
    used += (taken**2).sum(axis=1)
    best = None
    for i in range(m):
        if evidence.baseline.unstated[i] or i in state.spoken_for:
            continue
        rows = (owner == i) & (np.arange(len(z)) < evidence.readings)
        freedom = float((1 - used[rows]).sum()) * whiteness(evidence)
        energy = float((z[rows] ** 2).sum())
        if freedom < 2 or energy <= freedom:
            continue
        p_family = min(1.0, float(chdtrc(freedom, energy)) * m * state.families)
        weight = 0.5 * (energy - freedom - freedom * np.log(energy / freedom))
        value = float(weight - 0.5 * np.log(freedom / 2) - np.log(m))
        if p_family < LEVEL and (best is None or value > best.evidence):
            best = Excess(i, energy / freedom, freedom, value, p_family)
    return best


def whiteness(evidence: Evidence) -> float:
    """Share of the rows' energy that unknown directions leave to the noise."""
    removed = (1 - (1 - evidence.whiten.removed) ** 2).sum()
    return float(1 - removed / evidence.baseline.residual.size)


def serial_of(state: Search, sensor: int) -> Serial | None:
    """Whether one sensor's left-over runs smoothly along some order of its rows."""
    return serial_structure(state.evidence, state.left, sensor, DOUBT)


def unevenness(state: Search) -> Search:
    """Sensors whose left-over is not white after everything found."""
    m = len(state.baseline.unstated)
    open_sensors = [i for i in range(m) if i not in state.spoken_for]
    uneven = [serial_structure(state.evidence, state.left, i, LEVEL / m) for i in open_sensors]
    return replace(state, serial=(*state.serial, *(u for u in uneven if u is not None)))


def structures(state: Search) -> Search:
    """Patterns without a name in what the causes leave."""
    for _ in range(MOST):
        pattern = strongest(state, state.patterns)
        if pattern is None:
            break
        state = replace(state, structures=(*state.structures, pattern, *companions(state, pattern, state.patterns)))
    return state
