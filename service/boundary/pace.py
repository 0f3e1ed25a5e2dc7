"""How slow a client may be."""

SLOWEST = 4000
"""Bytes a second: a sixth of what a mobile line of the second generation (EDGE) carries."""
LATE = 1.0
"""Seconds: a clock that goes off later than this was held up by the service itself, and blames no client."""


def allowance(patience: float, size: int) -> float:
    """Seconds that ``size`` bytes may take on the slowest line, when a client is waited for ``patience`` seconds."""
    return patience + size / SLOWEST
