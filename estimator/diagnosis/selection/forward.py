"""Causes, and patterns without a name, added one after another until nothing is significant any more.

Before a scatter larger than stated is called excess noise, it is looked at without belief in the stated noise: no
signature and no pattern may stand out of it, and it may not run smoothly along any order of the rows.
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.special import chdtrc

from estimator.calibration.noise import with_the_others
from estimator.diagnosis.selection.search_state import (
    LEVEL,
    PLAIN,
    Excess,
    Found,
    Group,
    Search,
    begin,
    companions,
    strongest,
    total,
)
from estimator.diagnosis.signatures.autocorrelation import Serial, serial_structure

DECISIVE = 4.0
"""ln evidence by which a signature must beat mere excess noise to be believed without a look at the scatter."""

DOUBTFUL = 0.0
"""ln evidence from which on a scatter that is too large is as well a smooth course as noise, and is said to be both."""

MOST = 8
"""Different causes (and, apart from them, patterns) looked for in one session, each on as many sensors as show it."""


def causes(state: Search) -> Search:
    """Add causes until none is significant."""
    while len({f.best.cause.identifier for f in state.found}) < MOST:
        noisy = noisiest(state)
        best = strongest(state, state.traces)
        if noisy is not None and (best is None or noisy.evidence > weight(best) - DECISIVE):
            wary = with_unknown_noise(state, noisy.sensor)
            best = strongest(wary, wary.traces)
            uneven = course(state, noisy)
            if best is None and not patterned(state, wary, noisy):
                state = set_apart(state, *what_it_is(noisy, uneven))
                continue
            if best is not None and uneven is not None and uneven.evidence > max(weight(best), both(wary, best)):
                state = set_apart(state, uneven)
                continue
        if best is None:
            break
        found = (*state.found, best, *companions(state, best, state.traces))
        often = too_often(found)
        if often and all(f.best.cause.repeats > 1 for f in found if f.best.group in often):
            kept = tuple(f for f in found if f.best.group not in often)
            state = replace(state, found=kept, refuted=state.refuted | often)
        elif often:
            break
        else:
            state = replace(state, found=found)
    return state


def weight(found: Found) -> float:
    """ln evidence of the cause that leads a ranking, all its shapes together."""
    return found.ranking[0][1]


def both(wary: Search, first: Found) -> float:
    """ln evidence of a cause and of another one beside it, while the noise of a sensor is not believed."""
    state = replace(wary, found=(*wary.found, first))
    second = strongest(state, [t for t in state.traces if t.cause is not first.best.cause])
    state = state if second is None else replace(state, found=(*state.found, second))
    return total(state) - total(wary)


def too_often(found: Sequence[Found]) -> frozenset[Group]:
    """Causes named on a sensor more often than they can act there: then it is not that cause."""
    times = Counter(f.best.group for f in found)
    return frozenset(f.best.group for f in found if times[f.best.group] > f.best.cause.repeats)


def patterned(state: Search, wary: Search, noisy: Excess) -> bool:
    """Whether a sensor's scatter holds a pattern: one of its own that stands out of it, or one common to all sensors
    that explains more than this sensor's noise does."""
    common = [t for t in state.patterns if not t.shapes[0].sensors]
    own = [t.at((noisy.sensor,)) for t in wary.patterns if t.shapes[0].sensors]
    shared = strongest(state, common)
    return strongest(wary, own) is not None or (shared is not None and weight(shared) > noisy.evidence)


def with_unknown_noise(state: Search, sensor: int) -> Search:
    """The search that does not believe one sensor's stated noise: its signatures must stand out of its own scatter."""
    unstated = state.baseline.unstated.copy()
    unstated[sensor] = True
    baseline = replace(state.baseline, unstated=unstated)
    return replace(state, baseline=baseline, evidence=replace(state.evidence, baseline=baseline))


def what_it_is(noisy: Excess, uneven: Serial | None) -> tuple[Excess | Serial, ...]:
    """Scatter larger than stated: noise, a smooth course, or noise of which it is doubtful that it is none."""
    if uneven is None or uneven.evidence <= DOUBTFUL:
        return (noisy,)
    return (uneven,) if uneven.evidence > PLAIN else (noisy, replace(uneven, ratio=1.0))


def set_apart(state: Search, *scatter: Excess | Serial) -> Search:
    """The search begun anew with one sensor's variance as it is, known from its own residuals alone.

    On a sensor whose scatter is plainly no noise nothing more is looked for.
    """
    variance, unstated = state.baseline.variance.copy(), state.baseline.unstated.copy()
    for one in scatter:
        variance[:, one.sensor] *= one.ratio
        unstated[one.sensor] = True
    again = begin(replace(state.baseline, variance=variance, unstated=unstated), state.history, state.catalogue)
    excess = (*state.excess, *(s for s in scatter if isinstance(s, Excess)))
    serial = (*state.serial, *(s for s in scatter if isinstance(s, Serial)))
    return causes(replace(again, excess=excess, serial=serial))


def noisiest(state: Search) -> Excess | None:
    """The sensor whose left-over most exceeds its stated noise; None if none does significantly."""
    m = len(state.baseline.unstated)
    best = None
    for i, (energy, freedom) in enumerate(zip(*scatter(state), strict=True)):
        if state.baseline.unstated[i] or i in state.spoken_for or freedom < 2 or energy <= freedom:
            continue
        p_family = min(1.0, float(chdtrc(freedom, energy)) * m * state.families)
        gained = 0.5 * (energy - freedom - freedom * np.log(energy / freedom))
        value = float(gained - 0.5 * np.log(freedom / 2) - np.log(m))
        if p_family < LEVEL and (best is None or value > best.evidence):
            best = Excess(i, energy / freedom, freedom, value, p_family)
    return best


def scatter(state: Search) -> tuple[list[float], list[float]]:
    """Energy and degrees of freedom of every sensor's left-over readings."""
    evidence = state.evidence
    own = evidence.owner[: evidence.readings] == np.arange(len(state.baseline.unstated))[:, None]
    spare = evidence.spare - (state.taken()[: evidence.readings] ** 2).sum(axis=1)
    energy, freedom = own @ state.left[: evidence.readings] ** 2, own @ spare
    return energy.tolist(), freedom.tolist()


def loud(state: Search) -> list[bool]:
    """Whether each sensor's left-over is plainly larger than stated or, where nothing is stated, than the others'."""
    expected = state.baseline.expected
    excess = {e.sensor for e in state.excess}
    if expected is None:
        return [i in excess for i in range(len(state.baseline.unstated))]
    energy, freedom = map(np.array, scatter(state))
    alike = with_the_others(energy, freedom, expected)[1] > freedom
    return [i in excess or bool(expected[i] > 0 and not alike[i]) for i in range(len(expected))]


def course(state: Search, noisy: Excess) -> Serial | None:
    """Whether a sensor's scatter, larger than stated, runs smoothly along some order of its rows."""
    found = serial_structure(state.evidence, state.left, state.taken(), noisy.sensor, known=False)
    return None if found is None else replace(found, ratio=noisy.ratio, excess=noisy.evidence)


def unevenness(state: Search) -> Search:
    """Sensors whose left-over is not white after everything found."""
    unstated = state.baseline.unstated
    left, taken = state.left, state.taken()
    each = [
        serial_structure(state.evidence, left, taken, i, known=not unstated[i])
        for i in range(len(unstated))
        if i not in state.spoken_for
    ]
    uneven = [u for u in each if u is not None and u.p_value * len(unstated) < LEVEL]
    return replace(state, serial=(*state.serial, *uneven))


def structures(state: Search) -> Search:
    """Patterns without a name in what the causes leave."""
    for _ in range(MOST):
        pattern = strongest(state, state.patterns)
        if pattern is None:
            break
        state = replace(state, structures=(*state.structures, pattern, *companions(state, pattern, state.patterns)))
    return state
