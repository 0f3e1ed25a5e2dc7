"""Planning: what a session would tell, before it is measured.

`plan` takes a block on a two-axis stand and proposes or judges elevation, number of positions and positions;
`rank_of_orientations` says what a set of still orientations identifies, and what to add. Neither needs readings.
`missing` says what a session that is being measured still lacks.
"""

from estimator.planning.elevation import conditioning, optimal_elevation
from estimator.planning.missing import ExpectedSigma, Missing, missing
from estimator.planning.orientations import OrientationRank, proposed_orientations, rank_of_orientations
from estimator.planning.positions import OptimalPositions, optimal_positions
from estimator.planning.propose import plan
from estimator.planning.results import JudgedParameter, Plan, Request, Sweep, ToleranceSet

__all__ = [
    "ExpectedSigma",
    "JudgedParameter",
    "Missing",
    "OptimalPositions",
    "OrientationRank",
    "Plan",
    "Request",
    "Sweep",
    "ToleranceSet",
    "conditioning",
    "missing",
    "optimal_elevation",
    "optimal_positions",
    "plan",
    "proposed_orientations",
    "rank_of_orientations",
]
