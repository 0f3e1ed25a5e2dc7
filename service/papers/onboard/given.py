"""What every parameter file is written from, and what all of them say."""

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime

import numpy as np

from estimator.allan import BlockNoise
from estimator.nominal_vector import NominalVector
from estimator.session import ACCELEROMETER, GYROSCOPE, Array

STANDARD_GRAVITY = 9.80665
"""m/s², at which what is left of an accelerometer's error is stated."""
FRAME = (
    "It corrects the vector that the driver makes of the readings by their nominal scale and axes.",
    "The driver's sensor axes must be the block's.",
)
DIGITS = 9


@dataclass(frozen=True)
class Given:
    """The correction of one session."""

    unit: str
    session: str
    measured_at: datetime
    verdict: str
    """In the words of every page."""
    simulated: bool
    software: str
    vectors: dict[str, NominalVector]
    """By kind of sensor."""
    noise: BlockNoise | None = None
    """At rest; None where the session holds no rests."""

    @property
    def accelerometers(self) -> NominalVector | None:
        """None where the session calibrates none."""
        return self.vectors.get(ACCELEROMETER)

    @property
    def gyros(self) -> NominalVector | None:
        """None where the session calibrates none."""
        return self.vectors.get(GYROSCOPE)


def noisiest(given: Given, kind: str, term: str) -> float | None:
    """The largest size of a term of noise, SI; None where the session does not decide it of every sensor of a kind."""
    sensors = () if given.noise is None else given.noise.sensors
    sizes = [sensor.term(term).value for sensor in sensors if sensor.kind == kind]
    decided = [size for size in sizes if size is not None]
    return max(decided) if decided and len(decided) == len(sizes) else None


def heading(given: Given, system: str) -> Iterator[str]:
    """The first comments of a file."""
    yield f"{system} parameters of unit {given.unit}, by {given.software}"
    yield f"session {given.session}, measured {given.measured_at:%Y-%m-%dT%H:%M:%SZ}: {given.verdict}"
    if given.simulated:
        yield "SIMULATED: this unit does not exist"
    yield from FRAME


def commented(lines: Iterator[str]) -> list[str]:
    """As comments of all four systems."""
    return [f"# {line}" for line in lines]


def unmixed(vector: NominalVector) -> tuple[Array, Array]:
    """Offset (3,), m/s² (rad/s), and scale (3,) of a correction that keeps the axes apart, (fₙ − offset)·scale."""
    return vector.offset, 1.0 / np.diag(vector.matrix)


def misalignment(vector: NominalVector) -> float:
    """Largest share, in rad, of one axis in another that such a correction leaves."""
    _, scale = unmixed(vector)
    left = scale[:, None] * vector.matrix - np.eye(3)
    return float(np.abs(left).max())


def number(value: float) -> str:
    """A plain decimal."""
    return f"{value:.{DIGITS}g}"
