"""The entrants: the diagnosis, its rivals, and two limits that know more than the folder says."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from benchmarks.blind.charts import cusum, sprt
from benchmarks.blind.given import Claim, Given
from benchmarks.blind.learned import neural
from benchmarks.blind.regression import sparse
from benchmarks.blind.subspaces import bayes, chi_square, given_cause, matched, one_step

OURS = "imu-health"


@dataclass(frozen=True)
class Entrant:
    """A rival."""

    words: str
    method: Callable[[Given], list[Claim]]
    """Claims, the surest name first; a session that it cannot judge has none."""
    puts_right: bool = True
    """Whether the diagnosis's first step, which corrects the record, comes first and is part of the answer."""
    is_given_cause: bool = False
    """Whether it is given the cause that acts."""


ENTRANTS: Mapping[str, Entrant] = {
    "matched-subspaces": Entrant("matched subspaces of the whole catalogue", matched),
    "sparse": Entrant("sparse regression (STLSQ) over all signatures", sparse),
    "parity-step": Entrant("parity space, GLR of one step of one sensor", one_step, puts_right=False),
    "chi-square": Entrant("χ² of the residuals", chi_square, puts_right=False),
    "cusum": Entrant("CUSUM of each parameter over the history", cusum, puts_right=False),
    "sprt": Entrant("SPRT of each parameter over the history", sprt, puts_right=False),
    "neural": Entrant("neural posterior, learned from simulated sessions", neural),
    "bayes": Entrant("limit: exhaustive Bayes with the generator's prior", bayes),
    "given-cause": Entrant("limit: matched subspace that is given the cause", given_cause, is_given_cause=True),
}
