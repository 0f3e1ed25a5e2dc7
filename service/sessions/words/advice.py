"""Measurements that would settle the open points of a session."""

from estimator.message import joined, say, say_count
from estimator.results import Calibration
from estimator.session import ACCELEROMETER
from service.kit.measures import number


def what_to_add(calibration: Calibration) -> str:
    """The rows that would determine the open parameters of a session."""
    flipped, add = calibration.residuals.flipped, calibration.fit.add
    if flipped is not None and len(set(flipped)) == 1:
        return "measure the same positions in the other run too"
    if not add:
        return "more or other positions would show it"
    up = joined(", ", (f"({', '.join(number(x, 2) for x in direction)})" for direction in add))
    return say_count(
        "add {n} still orientation with up, in block axes, along {directions}",
        "add {n} still orientations with up, in block axes, along {directions}",
        len(add),
        directions=up,
    )


def too_few(calibration: Calibration) -> str:
    """The sentence that the session gives no uncertainty, with the remedy; empty where it gives one."""
    add = calibration.fit.positions_to_add
    if not add:
        return ""
    return say(
        "Too few positions for an uncertainty: add {add}, or state the standard errors of the readings. There are as "
        "many parameters as readings, so the noise cannot be estimated.",
        add=add,
    )


def left_open(calibration: Calibration) -> str:
    """The parameters that a calibration does not observe of its accelerometers, with the remedy; empty where it
    observes all.
    """
    needed = ("scale", "bias", "axis")
    felt = [s for s in calibration.sensors if s.kind == ACCELEROMETER and set(needed) <= set(s.observable)]
    blind = [s.name for s in felt if not all(s.observable[name] for name in needed)]
    if not blind or calibration.parity is not None:
        return ""
    missing = [name for name in needed if any(not s.observable[name] for s in felt)]
    who = "every accelerometer" if len(blind) == len(felt) else joined(", ", blind)
    parts = {"missing": joined(", ", missing), "sensors": who, "calibration": what_to_add(calibration)}
    return say("It does not observe {missing} of {sensors}: {calibration}.", **parts)
