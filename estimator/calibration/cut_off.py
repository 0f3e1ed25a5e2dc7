"""A channel that stood at the end of its range: recognised by the other sensors' readings, before any fit.

On a stand, and where a few readings are clipped, that is a cause which the diagnosis names. In arbitrary orientations
a channel that is cut off in a good part of the rows spoils every applied vector, so such a session is refused.
"""

import numpy as np

from estimator.errors import Problem, ScheduleError
from estimator.message import joined, say
from estimator.session import ACCELEROMETER, Array, CalibrationSession

SHARE = 0.2
"""Part of the rows at one and the same extreme reading from which a channel is looked at: fewer are the diagnosis' to
name (it leaves them out), and do not spoil the applied vectors of the others …"""

FEWEST = 4
"""Fewest readings at one extreme: two or three equal readings happen by quantisation."""

CHANGED = 1.0
"""m/s²; range of what the other sensors say of its input in those rows, from which it was cut off: a tenth of g, far
beyond what nominal axes and scales are off by."""

SHOWN = 6
"""Rows that a message names: enough to find the place, short enough to read."""


def require_whole_range(session: CalibrationSession) -> None:
    """ScheduleError with every accelerometer that was cut off; blocks of three cannot tell."""
    u = session.readings
    enough = max(FEWEST, SHARE * len(u))
    ends = (u.min(axis=0), u.max(axis=0))
    problems = []
    for end in ends:
        stood = u == end
        for i in np.flatnonzero((stood.sum(axis=0) >= enough) & (ends[0] < ends[1])):
            seen = expected(session, int(i))
            rows = np.flatnonzero(stood[:, i])
            if seen is not None and np.ptp(seen[rows]) > CHANGED:
                problems.append(
                    Problem(session.sensors[i].name, cut_off(float(end[i]), rows, float(np.ptp(seen[rows]))))
                )
    if problems:
        raise ScheduleError(problems)


def expected(session: CalibrationSession, i: int) -> Array | None:
    """(R,) input of sensor i by the others' nominal axes, m/s², up to a constant; None where they do not tell it."""
    others = [k for k, s in enumerate(session.sensors) if k != i and s.kind == ACCELEROMETER]
    if session.sensors[i].kind != ACCELEROMETER or len(others) < 3:
        return None
    axes = np.stack([session.sensors[k].nominal_axis for k in others])
    if np.linalg.matrix_rank(axes, tol=0.1) < 3:
        return None
    inputs = session.readings[:, others] / [session.sensors[k].nominal_scale for k in others]
    return np.asarray(inputs @ np.linalg.pinv(axes).T @ session.sensors[i].nominal_axis)


def cut_off(end: float, rows: Array, change: float) -> str:
    """Message: the clipped ``rows`` (k,), numbers from 0, with a remedy; ``end`` in reading units, ``change`` in
    m/s².
    """
    named = joined(", ", (str(row + 1) for row in rows[:SHOWN])) + (", …" if len(rows) > SHOWN else "")
    parts = {"end": f"{end:g}", "rows": len(rows), "row_names": named, "change": f"{change:.2g}"}
    return say(
        "reads exactly {end} in {rows} rows ({row_names}) although its input changes by {change} m/s² according to the "
        "other sensors: the channel is at the end of its range; use a wider range, or remove these rows",
        **parts,
    )
