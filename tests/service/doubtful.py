"""Sessions of one unit about whose verdict something is to be said."""

import json
from typing import Any

from tests.service.made_sessions import MICRO_G, session_bytes

LATE, EARLY = 45, 17
"""Rows: near the end, where the mean hardly feels it, and within the first run, where it passes for something else."""


def jumped(micro_g: float, row: int = LATE, *, seed: int = 2, **changes: Any) -> bytes:
    """A session in which A2's zero jumps once, and else nothing has happened."""
    document = json.loads(session_bytes(seed=seed, month=seed, **changes))
    volts = micro_g * MICRO_G * document["sensors"][1]["nominal_scale"]
    column = document["table"]["A2"]
    document["table"]["A2"] = [reading + volts * (j >= row) for j, reading in enumerate(column)]
    return json.dumps(document).encode()


REFERENCE = session_bytes(month=1)
JUMPED = (REFERENCE, jumped(51.0))
"""A reference, and a session whose A2 jumps by 51 µg of 50 µg allowed, although its mean is within tolerance."""
SLIGHTLY = (REFERENCE, jumped(15.0, LATE - 1))
"""A reference, and a session whose A2 jumps by less than a third of the tolerance."""
MISTAKEN = (REFERENCE, jumped(51.0, EARLY))
"""A reference, and a session whose A2 jumps so early that the quadratic term takes it up and passes for out of
tolerance.
"""
CLAUSE = "the bias of A2 has one step ("
"""Beginning of the reservation of `JUMPED`, before its size."""
