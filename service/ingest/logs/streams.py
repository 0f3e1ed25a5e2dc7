"""The samples of one triad of sensors in a log."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from estimator.session import ACCELEROMETER

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Stream:
    """One instance of an accelerometer or a gyro with three axes, in the order measured."""

    label: str
    """What the log calls it, with its instance."""
    kind: str
    """`accelerometer` or `gyroscope`."""
    time: Array
    """(n,) s, since any start that all streams of the log share."""
    values: Array
    """(n, 3) m/s² or rad/s."""
    temperature: Array | None = None
    """(n,) °C, where it is measured."""

    @property
    def unit(self) -> str:
        """Of its values."""
        return "m/s²" if self.kind == ACCELEROMETER else "rad/s"


def in_order(stream: Stream) -> Stream:
    """Without samples that are no numbers, by time: of two clocks in one log one may lag behind."""
    sound = np.isfinite(stream.time) & np.isfinite(stream.values).all(axis=1)
    order = np.flatnonzero(sound)[np.argsort(stream.time[sound], kind="stable")]
    temperature = None if stream.temperature is None else stream.temperature[order]
    return Stream(stream.label, stream.kind, stream.time[order], stream.values[order], temperature)
