"""What the parameters of a flight controller, an offset and a scale an axis, leave uncorrected."""

from collections.abc import Iterator

import numpy as np

from service.reports.onboard.given import STANDARD_GRAVITY, Given, misalignment, unmixed


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
