"""Two sessions of one unit beside each other: every parameter, its change, and the uncertainty of that change.

x_s = θ + J_s c + ε_s of a session s: θ the truth, c the stand's constant errors, ε_s what differs from session to
session, with covariance R_s. The total covariance of one session is C_s = J_s Σ_c J_sᵀ + R_s. Of two sessions on one
stand by like schedules, J_1 = J_2 and J c is in both: Var(x_2 − x_1) = R_1 + R_2. On different stands it is C_1 + C_2,
as the decision rule takes it everywhere; on one stand that is more. (JCGM 102, propagation of covariance.)
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from estimator.results import Calibration, Estimate, SensorCalibration
from estimator.session import Array
from service.errors import ConflictError
from service.judging.judge import judge
from service.records.decision import Judged
from service.records.event import Service
from service.records.session import ALL_PARAMETERS, StoredSession
from service.records.state import RecordState
from service.storage.store import Store

SAME = "Choose two different sessions: there is nothing to compare in one."
OF_TWO = "Session {first} is of unit {one} and session {second} of unit {other}: compare two sessions of one unit."


@dataclass(frozen=True, eq=False)
class Comparison:
    """The earlier session and the later one."""

    first: StoredSession
    second: StoredSession
    before: Calibration
    after: Calibration
    judged: Judged
    """The later one, judged as if the earlier one were its reference."""
    own: Mapping[tuple[str, str], float]
    """By sensor and parameter: standard uncertainty of the change without what the stand does to both alike. Empty
    where they were not measured on one stand."""
    services: tuple[Service, ...]
    """Between the two."""

    @property
    def stand(self) -> str | None:
        """That both were measured on; None where they were not."""
        return self.first.stand if self.first.stand == self.second.stand else None


def compare(store: Store, a: str, b: str, coverage_factor: float) -> Comparison:
    """Two sessions of one unit by their date, whichever is named first; NotFoundError, ConflictError."""
    if a == b:
        raise ConflictError(SAME)
    first, second = sorted((store.sessions.get(a), store.sessions.get(b)), key=lambda s: (s.started_at, s.id))
    if first.unit != second.unit:
        named = {"first": first.id, "second": second.id, "one": first.unit, "other": second.unit}
        raise ConflictError(OF_TWO.format(**named))
    known = store.calibrations.in_force((first.id, second.id))
    before, after = known[first.id], known[second.id]
    return Comparison(
        first=first,
        second=second,
        before=before,
        after=after,
        judged=judge(after, before, store.unit_types.of_unit(first.unit), coverage_factor),
        own=_own(before, after) if first.stand is not None and first.stand == second.stand else {},
        services=tuple(
            service
            for service in store.services.recorded(first.unit)
            if service.state is RecordState.ACCEPTED and first.started_at < service.at <= second.started_at
        ),
    )


def _own(before: Calibration, after: Calibration) -> dict[tuple[str, str], float]:
    """√(R_1 + R_2) of every parameter that both sessions tell."""
    earlier = {sensor.name: sensor for sensor in before.sensors}
    found = {
        (sensor.name, parameter): _spread(before, after, earlier[sensor.name], sensor, parameter)
        for sensor in after.sensors
        for parameter in ALL_PARAMETERS
        if sensor.name in earlier
    }
    return {key: spread for key, spread in found.items() if spread is not None}


def _spread(
    before: Calibration, after: Calibration, then: SensorCalibration, now: SensorCalibration, parameter: str
) -> float | None:
    if parameter == "axis":
        return _axis_spread(_axis_repeatability(before, then), _axis_repeatability(after, now))
    one: Estimate | None = getattr(then, parameter)
    other: Estimate | None = getattr(now, parameter)
    if one is None or other is None or one.repeatability is None or other.repeatability is None:
        return None
    size = abs(one.value or 0.0) if parameter == "scale" else 1.0
    return float(np.hypot(one.repeatability, other.repeatability)) / size if size else None


def _axis_spread(before: Array | None, after: Array | None) -> float | None:
    """Along the direction in which the change of the axis is known least, rad; of both covariances (3, 3), rad²."""
    if before is None or after is None:
        return None
    return float(np.sqrt(np.linalg.eigvalsh(before + after)[-1]))


def _axis_repeatability(calibration: Calibration, sensor: SensorCalibration) -> Array | None:
    """(3, 3) in block axes, rad²: each session has tangents of its own. None where it does not tell it."""
    names = [f"{sensor.name}.axis_1", f"{sensor.name}.axis_2"]
    if not set(names) <= set(calibration.names):
        return None
    places = [calibration.names.index(name) for name in names]
    own = sensor.axis_tangents @ calibration.repeatability[np.ix_(places, places)] @ sensor.axis_tangents.T
    return np.asarray(own) if np.isfinite(own).all() else None
