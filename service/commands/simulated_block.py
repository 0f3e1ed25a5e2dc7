"""The blocks that `imu-health simulate` measures: of what they are, and how they are noisy."""

from typing import Annotated

import numpy as np
import typer

from estimator.session import ACCELEROMETER, GYROSCOPE, TWO_AXIS_STAND, Array, CalibrationSession
from service.demo.blocks import MICRO_G
from service.demo.other_programmes import RATE_NOISE

USUAL_NOISE = {ACCELEROMETER: 2.5, GYROSCOPE: 0.3}
"""One sigma of an averaged reading, unless another is asked for: µg; pulses."""
Block = Annotated[
    str, typer.Option(help=f"What they are, {ACCELEROMETER} or {GYROSCOPE}: on a stand, gyros count pulses.")
]
Alpha = Annotated[
    float, typer.Option(min=1, max=89, help="Elevation of the head's axis, degrees; of gyros χ, to the Earth's axis.")
]
Noise = Annotated[
    float | None,
    typer.Option(min=0, help="One sigma of an averaged reading, µg; of gyros pulses.", show_default="2.5; 0.3"),
]


def check_block(block: str, programme: str) -> None:
    """A usage error where a programme is not simulated of such a block."""
    if block not in USUAL_NOISE:
        raise typer.BadParameter(f"--block is {block}; give {ACCELEROMETER} or {GYROSCOPE}")
    if block == GYROSCOPE and programme != TWO_AXIS_STAND:
        raise typer.BadParameter(f"--block {block}: {programme} does not show it; {TWO_AXIS_STAND} does")


def noise_of(schedule: CalibrationSession, noise: float | None) -> Array:
    """(m,) one sigma of an averaged reading, reading units: ``noise`` is µg, of a block of pulse gyros pulses."""
    own = USUAL_NOISE[schedule.block] if noise is None else noise
    found = [MICRO_G * own * s.nominal_scale if s.kind == ACCELEROMETER else RATE_NOISE for s in schedule.sensors]
    return np.array(found) if schedule.count_time is None else np.full(len(found), own)
