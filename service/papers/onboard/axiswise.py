"""Flight controllers: an offset and a scale an axis, of gyros an offset alone, and what that leaves uncorrected."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from estimator.session import Array
from service.errors import ConflictError
from service.papers.onboard.given import STANDARD_GRAVITY, Given, misalignment, unmixed

LEAST = 0.5
"""Share of its nominal scale that an axis must feel along itself."""
MOST_ASKEW = 0.1
"""rad: 1 m/s² at 1 g; a mounting is off by some hundredths."""


@dataclass(frozen=True)
class Names:
    """What a system calls them, with a blank for the axis."""

    offset: str
    scale: str
    gyro_offset: str


def parameters(given: Given, names: Names) -> Iterator[tuple[str, float]]:
    """Name and value, m/s², none and rad/s, of ``(raw − offset)·scale`` and of gyros ``raw − offset``.

    ConflictError where the axes lie so far from the nominal ones that no scale an axis puts them right."""
    for kind, vector in given.vectors.items():
        if not np.all(np.diag(vector.matrix) > LEAST) or misalignment(vector) > MOST_ASKEW:
            raise ConflictError(
                f"The {kind}s' axes lie too far from their nominal ones: an offset and a scale an axis cannot correct "
                "them. Look for exchanged or reversed channels, or hand on for Kalibr or ROS 2."
            )
    if given.accelerometers is not None:
        offset, scale = unmixed(given.accelerometers)
        yield from _named(names.offset, offset)
        yield from _named(names.scale, scale)
    if given.gyros is not None:
        yield from _named(names.gyro_offset, given.gyros.offset)


def _named(name: str, values: Array) -> Iterator[tuple[str, float]]:
    for axis, value in zip("XYZ", values, strict=True):
        yield name.format(axis), float(value)


def left_of(given: Given) -> Iterator[str]:
    """One sentence a kind of sensor."""
    if given.accelerometers is not None:
        angle = misalignment(given.accelerometers)
        force = angle * STANDARD_GRAVITY
        bent = given.accelerometers.curvature * STANDARD_GRAVITY**2
        yield (
            f"Left in specific force: axes up to {1e3 * angle:.3g} mrad askew, {force:.2g} m/s² at 1 g; "
            f"quadratic terms, up to {bent:.2g} m/s² at 1 g."
        )
    if given.gyros is not None:
        angle, (_, scale) = misalignment(given.gyros), unmixed(given.gyros)
        yield (
            f"Left in angular rate: scale factors, up to {1e6 * float(np.abs(scale - 1).max()):.3g} ppm, "
            f"and axes up to {1e3 * angle:.3g} mrad askew: gyros have an offset only."
        )
