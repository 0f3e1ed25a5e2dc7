"""The identifiers that are hidden, with what each of them needs, as the catalogue's table states it."""

from dataclasses import dataclass

SENSOR, WHOLE, HISTORY = "sensor", "whole", "history"


@dataclass(frozen=True)
class Hidden:
    """One cause: its number of amplitudes, who it acts on and what the session must hold."""

    size: int
    scope: str
    needs: frozenset[str] = frozenset()
    free: int | None = None
    """Free parameters of the explanation where they are not the amplitudes (a shape that is searched for)."""

    @property
    def parameters(self) -> int:
        """Number of parameters that parsimony counts."""
        return self.size if self.free is None else self.free


def _hidden(size: int, scope: str, *needs: str, free: int | None = None) -> Hidden:
    return Hidden(size, scope, frozenset(needs), free)


CATALOGUE = {
    "cubic-nonlinearity": _hidden(1, SENSOR),
    "scale-asymmetry": _hidden(1, SENSOR),
    "cross-coupling": _hidden(2, SENSOR),
    "bias-temperature": _hidden(1, SENSOR, "temperature"),
    "scale-temperature": _hidden(1, SENSOR, "temperature"),
    "bias-ramp": _hidden(1, SENSOR, "time"),
    "warm-up": _hidden(1, SENSOR, "time", free=2),
    "bias-jump": _hidden(1, SENSOR, free=2),
    "hysteresis": _hidden(1, SENSOR),
    "saturation": _hidden(1, SENSOR, free=2),
    "odd-quadratic": _hidden(1, SENSOR),
    "bias-asymmetry": _hidden(1, SENSOR),
    "cross-axis-quadratic": _hidden(2, SENSOR),
    "scale-ramp": _hidden(1, SENSOR, "time"),
    "axis-creep": _hidden(2, SENSOR, "time"),
    "temperature-rate": _hidden(1, SENSOR, "temperature", "time"),
    "bias-per-position": _hidden(2, SENSOR, "both runs"),
    "reading-outlier": _hidden(1, SENSOR, free=2),
    "excess-noise": _hidden(1, SENSOR, "stated noise"),
    "beta-eccentricity": _hidden(2, WHOLE),
    "beta-second-harmonic": _hidden(2, WHOLE),
    "beta-scale": _hidden(1, WHOLE),
    "axis-wobble": _hidden(2, WHOLE),
    "levelling-y": _hidden(1, WHOLE, "both runs"),
    "alpha-shift": _hidden(1, WHOLE, "both runs"),
    "flip-misalignment": _hidden(3, WHOLE, "both runs"),
    "stand-drift": _hidden(1, WHOLE, "time"),
    "positions-swapped": _hidden(0, WHOLE, free=2),
    "channels-swapped": _hidden(0, HISTORY, "both runs", free=2),
    "sign-reversed": _hidden(0, HISTORY, "both runs", free=1),
    "runs-swapped": _hidden(0, HISTORY, "both runs"),
    "beta-reversed": _hidden(0, HISTORY, "both runs"),
    "alpha-entry": _hidden(1, HISTORY, "both runs", "accelerometers"),
    "gravity-entry": _hidden(1, HISTORY, "history", "both runs", "accelerometers"),
    "sensor-drift": _hidden(4, HISTORY, "history", "both runs"),
    "remount-rotation": _hidden(3, HISTORY, "history", "both runs"),
    "g-sensitivity": _hidden(3, HISTORY, "history", "both runs", "gyros"),
    "latitude-entry": _hidden(1, HISTORY, "history", "both runs", "gyros"),
    "meridian-error": _hidden(1, WHOLE, "both runs", "gyros"),
    "thermal-lag": _hidden(1, SENSOR, "temperature", "time", free=2),
    "vibration-rectification": _hidden(1, SENSOR, "vibration", "accelerometers"),
    "bias-temperature-curve": _hidden(2, SENSOR, "temperature"),
    "scale-temperature-curve": _hidden(2, SENSOR, "temperature"),
}

DISCRETE = frozenset({"positions-swapped", "channels-swapped", "sign-reversed", "runs-swapped", "beta-reversed"})
"""Record errors without an amplitude: they have the strength they have."""

TANGENT = frozenset({"cross-coupling", "axis-creep", "cross-axis-quadratic"})
"""Two components along tangent vectors that a diagnosis may choose as it likes: only the length is compared."""
