"""Lever arms of the accelerometers from the turn axis: their size, which of them are certain, and the benefit.

A sensor is named where the turns move it significantly, over all sensors together, and no rival does as well; a rival
within 9 of it in χ², its columns paid for, stands beside the name. Where rivals add to the lever arm, its uncertainty
grows with what it leaves.

Positions that the file states count from any one origin. They are taken off first; what is left must be one lever arm
common to all sensors, that of the origin. Sensors that need another one do not sit where the file says.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.alignment.align import Record, table_wobble
from estimator.alignment.axes import inputs_of, of_kind
from estimator.alignment.levers import coefficients, place_of, positions_of, turning
from estimator.alignment.pieces import Pieces, pieces
from estimator.alignment.turned import RIVALS, LeverResponse, lever_response
from estimator.applied_vector import gravity
from estimator.session import ACCELEROMETER, Array, Sensor
from estimator.significance import p_value as chance_of

LEVEL = 0.003
"""False-alarm rate over all accelerometers of a session, as in diagnoses of calibrations."""
DECISIVE = 9.0
"""Difference of χ² from which a rival is distinguished: three standard errors."""
FEWEST = 3
"""Fewest sensors among which one that contradicts the others can be identified."""


@dataclass(frozen=True, eq=False)
class FittedLeverArm:
    """One accelerometer and how far it stands from the turn axis, or from where the file says."""

    sensor: Sensor
    place: Array
    """(2,) r_x, r_y, m."""
    covariance: Array
    """(2, 2) m²."""
    response: LeverResponse
    named: bool
    rivals: tuple[str, ...]
    """The rivals, of `RIVALS`, that explain the readings as well."""
    more: float
    """Chance of further effects of the turns as large where there are none; 1 where the lever arm is not named."""
    other: str
    """The rival that fits instead, far better; empty where none does."""

    @property
    def distance(self) -> tuple[float, float]:
        """Length of the horizontal lever arm and its sigma, m."""
        length = float(np.hypot(*self.place))
        along = self.place / length if length else np.array([1.0, 0.0])
        return length, float(np.sqrt(along @ self.covariance @ along))


@dataclass(frozen=True, eq=False)
class LeverArms:
    """The lever arms of a session."""

    estimates: tuple[FittedLeverArm, ...]
    """Every accelerometer whose lever arm shows."""
    upright: tuple[str, ...]
    """Accelerometers along the turn axis, whose lever arm cannot be seen."""
    origin: tuple[Array, Array] | None
    """Position of the origin of the stated positions relative to the turn axis, (2,) m, and covariance (2, 2); None
    where the file states no positions or they contradict the turns altogether.
    """
    stated: bool
    pieces: Pieces
    lean: float
    """One sigma of the acceleration that the axis' lean adds across it, m/s²."""

    @property
    def named(self) -> tuple[FittedLeverArm, ...]:
        """The sensors that are certainly off the turn axis."""
        return tuple(arm for arm in self.estimates if arm.named)


def lever_arms(record: Record) -> LeverArms:
    """The lever arms of an alignment."""
    session, motion = record.session, record.motion
    sensors = [session.sensors[i] for i in of_kind(session, ACCELEROMETER)]
    inputs = inputs_of(session, ACCELEROMETER)[0][record.first :]
    parts = pieces(inputs, turning(motion.rates[:, 2], motion.row), record.angle, record.stops, motion.row)
    lean = gravity(session.site) * table_wobble(session)
    responses = _responses(parts, sensors, lean)
    stated, origin = positions_of(sensors) is not None, None
    if stated and len(responses) > 1:
        origin = _origin(responses, sensors)
        parts = replace(parts, values=parts.values - parts.levers @ _common(sensors, origin[0]).T)
        responses = _responses(parts, sensors, lean)
    seen = {response.sensor for response in responses}
    arms = tuple(
        _judged(response, sensors[response.sensor], len(parts.time), LEVEL / len(responses)) for response in responses
    )
    upright = tuple(sensor.name for i, sensor in enumerate(sensors) if i not in seen)
    return LeverArms(arms, upright, origin, stated, parts, lean)


def _responses(parts: Pieces, sensors: Sequence[Sensor], lean: float) -> list[LeverResponse]:
    candidates = (lever_response(parts, i, sensor.nominal_axis, lean) for i, sensor in enumerate(sensors))
    return [response for response in candidates if response is not None]


def _common(sensors: Sequence[Sensor], origin: Array) -> Array:
    """(m, 2) c and d of all sensors, m, where all stand at ``origin`` (2,), m."""
    axes = np.stack([sensor.nominal_axis for sensor in sensors])
    return coefficients(axes, np.tile([*origin, 0.0], (len(sensors), 1)))


def _origin(responses: Sequence[LeverResponse], sensors: Sequence[Sensor]) -> tuple[Array, Array]:
    """The lever arm (2,), m, that all sensors share, and its covariance; one that contradicts all others left out."""
    p_value, origin = _shared(responses, sensors)
    if p_value >= LEVEL or len(responses) < FEWEST:
        return origin
    others = [
        _shared([response for response in responses if response is not omitted], sensors) for omitted in responses
    ]
    best, without = max(others, key=lambda other: other[0])
    return without if best >= LEVEL else origin


def _shared(responses: Sequence[LeverResponse], sensors: Sequence[Sensor]) -> tuple[float, tuple[Array, Array]]:
    """Probability that lever arms of one length scatter as much, then that length (2,), m, and its covariance."""
    information, weighted, square = np.zeros((2, 2)), np.zeros(2), 0.0
    for response in responses:
        place, covariance = _place(response, sensors[response.sensor])
        weight = np.linalg.inv(covariance)
        information, weighted = information + weight, weighted + weight @ place
        square += float(place @ weight @ place)
    origin = np.linalg.solve(information, weighted)
    columns = 2 * len(responses) - 2
    freedom = min(response.freedom for response in responses)
    if columns < 1 or freedom <= 0:
        return 1.0, (origin, np.linalg.inv(information))
    excess = max(square - float(weighted @ origin), 0.0)
    return float(chance_of(excess, columns, freedom)), (origin, np.linalg.inv(information))


def _place(response: LeverResponse, sensor: Sensor) -> tuple[Array, Array]:
    """Position (2,), m, and covariance (2, 2), m²."""
    matrix = place_of(sensor.nominal_axis)
    return matrix @ response.lever, matrix @ response.covariance @ matrix.T


def _judged(response: LeverResponse, sensor: Sensor, count: int, level: float) -> FittedLeverArm:
    """Decides whether a lever arm is named, and with which rivals; ``count``: number of pieces."""
    worth = {rival: response.worth(rival, count) for rival in RIVALS}
    evidence, best = response.worth("lever arm", count), max(worth, key=lambda rival: worth[rival])
    beaten = worth[best] > evidence + DECISIVE
    more = response.p_value("beyond")
    excess = response.excess if more < level else 1.0
    named = response.p_value("lever arm", excess) < level and not beaten
    acts = beaten and response.p_value(best) < level
    place, covariance = _place(response, sensor)
    return FittedLeverArm(
        sensor=sensor,
        place=place,
        covariance=excess * covariance,
        response=response,
        named=named,
        rivals=tuple(rival for rival in RIVALS if worth[rival] > evidence - DECISIVE) if named else (),
        more=more if named else 1.0,
        other=best if acts else "",
    )
