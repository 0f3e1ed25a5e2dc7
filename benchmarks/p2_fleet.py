"""P2: a fleet of such sessions in one call, against `calibrate` in a loop and against bare least-squares solves.

In a loop every result is read; against the solves, which give none, all sessions are solved and nothing is read.

The bare solve is `numpy.linalg.lstsq` on the whitened Jacobian of each sensor of each session, at the solution: no
model, no iteration, no covariance, no stand errors.
"""

import numpy as np

from benchmarks.block import sessions
from benchmarks.figures import Figure, side_by_side
from estimator import calibrate, calibrate_many
from estimator.applied_vector import stand_geometry
from estimator.forward import jacobian
from estimator.parameters import nominal

SESSIONS = 10_000
FEW = 500
"""Sessions of the loop, which takes as long for each however many there are."""
NOTE = """
P2 reaches its target against the solves, and misses that against the loop: read one by one, the results take more
than half of the time, and in the loop no longer.
"""


def run() -> list[Figure]:
    """Measures against both peers."""
    fleet = sessions(SESSIONS)
    geometry = stand_geometry(fleet[0])
    J = jacobian(nominal(fleet[0].sensors), geometry.n, geometry.norm)
    stacked = [(J[:, i] / 3e-6, s.readings[:, i] / 3e-6) for s in fleet for i in range(len(s.sensors))]
    work, some = "calibrate {:,} sessions of one schedule in one call, results {}", fleet[:FEW]
    loop = side_by_side(lambda: list(calibrate_many(some)), lambda: [calibrate(s) for s in some], rounds=5)
    bare = side_by_side(
        lambda: calibrate_many(fleet), lambda: [np.linalg.lstsq(A, y, rcond=None) for A, y in stacked], rounds=5
    )
    return [
        Figure("P2, loop", work.format(FEW, "read"), "calibrate in a loop", *loop, "20"),
        Figure(
            "P2, solves",
            work.format(SESSIONS, "read lazily"),
            "bare numpy.linalg.lstsq of every sensor",
            *bare,
            "at least 1/2",
        ),
    ]
