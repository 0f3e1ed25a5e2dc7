"""A small session with any effect in it, and the terms that are found there."""

from functools import cache

from estimator.causes import CATALOGUE
from estimator.causes.contract import Signature
from estimator.diagnosis.diagnose import initial_state
from estimator.diagnosis.posterior.explained import restart_from
from estimator.diagnosis.posterior.search import search
from estimator.diagnosis.posterior.solve import SessionTerms, TermSolution, solve
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.residuals.whitened import WhitenedResiduals
from estimator.session import Array, CalibrationSession
from tests.estimator.diagnosis.small import measured

SIGNATURES = [c for c in CATALOGUE if isinstance(c, Signature)]


def session_of(added: Array | float = 0.0, history: tuple[CalibrationSession, ...] = ()) -> SessionTerms:
    """The terms of four accelerometers on a stand with something added to their readings (R, m), V."""
    state = initial_state(baseline_of(measured(added)), [baseline_of(h) for h in history], CATALOGUE)
    return SessionTerms.of(state.residuals, SIGNATURES)


@cache
def sound() -> SessionTerms:
    """The same with nothing added."""
    return session_of()


def places(session: SessionTerms) -> list[tuple[str, tuple[int, ...]]]:
    """The names and sensors of the likeliest terms."""
    return [term.place for term in search(session.model)]


def solved(
    session: CalibrationSession, history: tuple[CalibrationSession, ...] = ()
) -> tuple[TermSolution, TermSolution]:
    """The likeliest solution, and that in the noise as stated."""
    state = initial_state(baseline_of(session), [baseline_of(h) for h in history], CATALOGUE)

    def residuals_of(baseline: Baseline) -> WhitenedResiduals:
        return state.residuals if baseline is state.baseline else restart_from(state, baseline).residuals

    return solve(state.baseline, residuals_of, SIGNATURES)
