"""The search for causes: one after another, each weighed against all others, confirmed together."""

from estimator.diagnosis.selection.backward import (
    best_pair,
    confirmed,
    judge_courses,
    judge_structures,
    settle,
    without_needless_drift,
)
from estimator.diagnosis.selection.forward import causes, structures, unevenness
from estimator.diagnosis.selection.search_state import Search


def search(start: Search) -> Search:
    """Causes, then what they leave."""
    state = confirmed(best_pair(without_needless_drift(settle(causes(start)))))
    return unevenness(confirmed(judge_courses(judge_structures(structures(state)))))
