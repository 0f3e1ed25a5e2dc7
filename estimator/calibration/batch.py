"""Many sessions at once: sessions of one schedule are calibrated in one vectorised call."""

from collections import defaultdict
from collections.abc import Hashable, Sequence

import numpy as np

from estimator.calibration.stand import calibrate_stand
from estimator.results import Calibration
from estimator.session import CalibrationSession

CHUNK = 500
"""Sessions solved together; bounds the memory of the normal matrices."""


def schedule(session: CalibrationSession) -> Hashable:
    """What two sessions must share to be solved together: everything but the readings."""
    assert session.beta is not None
    assert session.flipped is not None
    sensors = tuple((s.kind, s.nominal_axis.tobytes(), s.nominal_scale, s.bias_repeatability) for s in session.sensors)
    arrays = (session.beta.tobytes(), session.flipped.tobytes(), session.mounting.tobytes())
    return session.site, session.stand, session.count_time, sensors, arrays


def calibrate_many(sessions: Sequence[CalibrationSession]) -> list[Calibration]:
    """Calibrations of averaged two-axis-stand sessions, one a session, in order.

    Sessions that share a schedule are solved together, `CHUNK` at a time.
    """
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    for k, session in enumerate(sessions):
        groups[schedule(session)].append(k)
    found: dict[int, Calibration] = {}
    for members in groups.values():
        for chunk in np.array_split(members, -(-len(members) // CHUNK)):
            results = calibrate_stand([sessions[k] for k in chunk])
            found.update(zip(map(int, chunk), results, strict=True))
    return [found[k] for k in range(len(sessions))]
