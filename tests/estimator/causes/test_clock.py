"""A clock may count from any moment: far below 0 what follows time is estimated as from 0."""

import numpy as np

from estimator import diagnose, read_session
from tests.builders import accelerometer_block


def test_a_clock_far_below_zero_tells_of_warming_up_as_one_from_zero() -> None:
    """exp(−t/τ) overflowed, and every score of the cause was no number."""
    document = accelerometer_block(3, positions=12)
    time = np.array(document["table"]["time_s"])
    for name in ("A1", "A2", "A3"):
        document["table"][name] = (np.array(document["table"][name]) + 3e-4 * np.exp(-time / 300.0)).tolist()
    from_zero = diagnose(read_session(document)).findings
    document["table"]["time_s"] = (time - 1e9).tolist()
    below = diagnose(read_session(document)).findings
    assert "warm-up" in [one.cause for one in from_zero]
    assert [one.cause for one in below] == [one.cause for one in from_zero]
