"""The reference of a recording: the calibrated sensors, their parity space, and the trace of one sensor's change
there.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space

from estimator.errors import Problem, ScheduleError, problem_at
from estimator.message import say, say_count
from estimator.parameters import ELEMENTS
from estimator.results import Calibration, SensorCalibration
from estimator.session import ACCELEROMETER, Array, Sensor

FEWEST = 4
"""Sensors: three measure the vector, one more checks them."""
LEAST_VISIBLE = 1e-6
"""Share of a sensor that shows in parity; of less the others say nothing of it."""
QUADRATIC = ELEMENTS.index("quadratic")
NEEDED = ("scale", "bias", "axis")
"""Parameters that the reference must hold of a sensor for it to take part."""


@dataclass(frozen=True, eq=False)
class ParityReference:
    """m calibrated sensors of one kind; d = m − 3."""

    names: tuple[str, ...]
    kind: str
    column: NDArray[np.intp]
    """(m,) place of each among the recording's sensors."""
    scale: Array
    """(m,) K, reading units per m/s² (rad/s)."""
    bias: Array
    """(m,) b, m/s² (rad/s)."""
    quadratic: Array
    """(m,) c, s²/m; zero where the reference does not know it, and of gyros: what the Earth's rate shows of it is far
    too little at the rates of a recording."""
    offset: Array
    """(m,) reading that stands for zero, reading units."""
    axes: Array
    """(m, 3) H, dimensionless."""
    tangents: Array
    """(m, 3, 2) orthonormal, orthogonal to each axis, dimensionless."""
    covariance: Array
    """(5 m, 5 m) covariance of the reference, SI with scale relative; zero where it does not know an element."""
    repeatability: Array
    """(m,) one sigma of the zero from one use to the next, m/s² (rad/s)."""
    position: Array | None
    """(m, 3) where they sit, m, block axes, from any one origin; None unless all of them say so."""
    parity: Array
    """(m, d) V, orthonormal, dimensionless."""

    @property
    def visible(self) -> Array:
        """(m,) relative share of a sensor's change, in energy, that lies in parity space: 1 − eᵢᵀ(HᵀH)⁻¹eᵢ."""
        return np.asarray((self.parity**2).sum(axis=1))

    def of(self, sensors: Array) -> "ParityReference":
        """Some of the sensors, by number (n,)."""
        own = (5 * np.asarray(sensors)[:, None] + np.arange(5)).ravel()
        some = {name: getattr(self, name)[sensors] for name in BY_SENSOR}
        return replace(
            self,
            names=tuple(self.names[k] for k in sensors),
            covariance=self.covariance[np.ix_(own, own)],
            position=None if self.position is None else self.position[sensors],
            parity=null_space(some["axes"].T),
            **some,
        )

    def inputs(self, readings: Array) -> Array:
        """(R, m) applied inputs by the sensors, m/s² (rad/s): u/K − b − c·a², from readings (R, n) of all n sensors of
        the recording, reading units.
        """
        return self.felt(readings[:, self.column])

    def felt(self, readings: Array) -> Array:
        """(R, m) applied inputs from the readings (R, m) of these sensors alone."""
        w = (readings - self.offset) / self.scale - self.bias
        return 2.0 * w / (1.0 + np.sqrt(np.maximum(1.0 + 4.0 * self.quadratic * w, 0.0)))

    def readings(self, inputs: Array) -> Array:
        """(R, m) reading units, what the sensors read at inputs (R, m), m/s² (rad/s)."""
        return np.asarray(self.scale * (inputs + self.bias + self.quadratic * inputs**2) + self.offset)

    def others(self, inputs: Array) -> Array:
        """(R, m) input of each sensor as the others predict it, m/s² (rad/s), from inputs (R, m)."""
        return np.asarray(inputs - inputs @ self.parity @ self.parity.T / np.maximum(self.visible, LEAST_VISIBLE))

    def vector(self, inputs: Array) -> Array:
        """(R, 3) the vector that fits the inputs (R, m) best, m/s² (rad/s)."""
        return np.asarray(inputs @ np.linalg.pinv(self.axes).T)

    def signatures(self, norm: float) -> Array:
        """(m, 4, 5) change of a row of ΔA, m/s² (rad/s) per SI unit of each element of `parameters.ELEMENTS`, scale
        relative; ``norm`` is g, m/s² (rad/s).

        The quadratic term is no straight line and stays zero here.
        """
        shown = np.zeros((len(self.names), 4, 5))
        shown[:, 0, 0] = self.bias
        shown[:, 1:, 0] = norm * self.axes
        shown[:, 0, 1] = 1.0
        shown[:, 1:, 3:] = norm * self.tangents
        return shown


BY_SENSOR = ("column", "scale", "bias", "quadratic", "offset", "axes", "tangents", "repeatability")
"""Arrays of a reference whose first axis is the sensors."""


def reference_of(sensors: Sequence[Sensor], calibration: Calibration, kind: str) -> ParityReference:
    """The calibrated sensors of one kind that a recording shares with its reference.

    Raises
    ------
    ScheduleError : a sensor that the reference does not have, or three usable ones or fewer.
    """
    members = [(k, s) for k, s in enumerate(sensors) if s.kind == kind]
    known = {s.name: s for s in calibration.sensors if s.kind == kind}
    unknown = [
        problem_at(
            f"sensors[{k + 1}].name", "{name} is not in the reference calibration; name sensors as there", name=s.name
        )
        for k, s in members
        if s.name not in known
    ]
    if unknown:
        raise ScheduleError(unknown)
    used = [(k, s, known[s.name]) for k, s in members if all(known[s.name].observable[part] for part in NEEDED)]
    if len(used) < FEWEST:
        raise ScheduleError([Problem("sensors", too_few(len(used), len(members), kind))])
    return assembled(used, calibration, kind)


def too_few(used: int, present: int, kind: str) -> str:
    """The reason why there is no parity, as a message."""
    if present >= FEWEST:
        parts = {"used": used, "present": present, "kind": kind, "fewest": FEWEST}
        return say(
            "the reference calibration has scale factor, bias and axis of {used} of {present} {kind}s; parity needs "
            "{fewest}: first calibrate the block with a programme that observes all three",
            **parts,
        )
    return say_count(
        "{n} {kind} leaves no redundancy; parity needs {fewest} or more, otherwise calibrate instead",
        "{n} {kind}s leave no redundancy; parity needs {fewest} or more, otherwise calibrate instead",
        present,
        kind=kind,
        fewest=FEWEST,
    )


def assembled(
    used: list[tuple[int, Sensor, SensorCalibration]], calibration: Calibration, kind: str
) -> ParityReference:
    """The arrays of the usable sensors."""
    known = [s for _, _, s in used]
    places = [calibration.names.index(f"{s.name}.{element}") for s in known for element in ELEMENTS]
    scale = np.array([s.scale.value for s in known], dtype=float)
    relative = np.ones((len(used), 5))
    relative[:, 0] = 1.0 / scale
    covariance = np.nan_to_num(calibration.covariance[np.ix_(places, places)])
    if kind != ACCELEROMETER:
        covariance[QUADRATIC::5] = covariance[:, QUADRATIC::5] = 0.0
    axes = np.stack([np.asarray(s.axis) for s in known])
    placed = [s.position for _, s, _ in used if s.position is not None]
    return ParityReference(
        names=tuple(s.name for s in known),
        kind=kind,
        column=np.array([k for k, _, _ in used]),
        scale=scale,
        bias=np.array([s.bias.value for s in known], dtype=float),
        quadratic=np.array([0.0 if kind != ACCELEROMETER else s.quadratic.value or 0.0 for s in known]),
        offset=np.array([s.nominal_offset or 0.0 for _, s, _ in used]),
        axes=axes,
        tangents=np.stack([s.axis_tangents for s in known]),
        covariance=covariance * np.outer(relative, relative),
        repeatability=np.array([s.bias_repeatability for _, s, _ in used]),
        position=np.stack(placed) if len(placed) == len(used) else None,
        parity=null_space(axes.T),
    )
