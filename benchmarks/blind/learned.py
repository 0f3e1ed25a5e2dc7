"""A neural posterior, `benchmarks.study.neural`: it knows no catalogue of signatures, only simulated sessions."""

from benchmarks.blind.given import Claim, Given
from benchmarks.details import PROJECT
from benchmarks.study.neural.network import answer

NETWORK = PROJECT / "build" / "neural.npz"
"""File to which ``python -m benchmarks.study.neural`` writes the network's weights."""


def neural(given: Given) -> list[Claim]:
    """The network's likeliest cause, as the only claim."""
    found = answer(NETWORK, given.state.residuals)
    sensors = [] if found.sensor is None else [given.state.names[found.sensor]]
    return [Claim(found.log_odds, {"cause": found.cause, "sensors": sensors})]
