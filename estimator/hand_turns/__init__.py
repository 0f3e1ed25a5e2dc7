"""Gyros calibrated by hand: turns of a raw log, between the directions that accelerometers give at the rests."""

from estimator.hand_turns.fit import ScatteredTurns, TurnedGyros, calibrate_turned
from estimator.hand_turns.recording import RestDirections, TurnedLog

__all__ = ["RestDirections", "ScatteredTurns", "TurnedGyros", "TurnedLog", "calibrate_turned"]
