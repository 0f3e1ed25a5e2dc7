"""What to measure so that a session tells what it leaves open."""

from estimator.results import Calibration
from service.units import number


def what_to_add(calibration: Calibration) -> str:
    """The rows that would tell what a session leaves open."""
    flipped, add = calibration.residuals.flipped, calibration.fit.add
    if flipped is not None and len(set(flipped)) == 1:
        return "measure the same positions in the other run too"
    if not add:
        return "more or other positions would tell it"
    up = ", ".join(f"({', '.join(number(x, 2) for x in direction)})" for direction in add)
    return f"add {len(add)} still orientation{'s' if len(add) > 1 else ''} with up, in block axes, along {up}"
