"""A missing cause shows as a crowd: many names at once patch up what no cause of the catalogue describes."""

from collections.abc import Set
from dataclasses import replace

from estimator.diagnosis.selection.forward import with_structures
from estimator.diagnosis.selection.search_state import SearchState
from estimator.diagnosis.signatures.traces import Group

MOST_LIKELY = 2
"""Different names in one session that are believed without a look at parity space."""


def without_crowd(state: SearchState, held_there: Set[Group]) -> SearchState:
    """The state without a crowd of names that parity space does not bear out, where none explains half of what they do.

    ``held_there``: what holds in parity space.
    """
    if not crowded(state):
        return state
    loose = [f for f in state.found if f.best.group not in held_there]
    share = [f.best.statistic for f in loose]
    if len({f.best.cause.identifier for f in loose}) <= MOST_LIKELY or max(share) > 0.5 * sum(share):
        return state
    kept = tuple(f for f in state.found if f not in loose)
    left = with_structures(replace(state, found=kept, structures=()))
    return left if left.structures else state


def crowded(state: SearchState) -> bool:
    """Whether more happened than misfortunes are likely at once: different names, structures, sensors that scatter."""
    names = {f.best.cause.identifier for f in state.found}
    return len(names) + bool(state.structures) + len(state.scatter_attributed) > MOST_LIKELY
