"""Rates with their intervals."""

from dataclasses import dataclass
from math import sqrt

Z = 1.96


@dataclass(frozen=True)
class Rate:
    """A number of hits among trials."""

    hits: int
    trials: int

    @property
    def share(self) -> float:
        """0 … 1; NaN of nothing."""
        return self.hits / self.trials if self.trials else float("nan")

    def interval(self) -> tuple[float, float]:
        """95 % interval after Wilson (1927)."""
        if not self.trials:
            return 0.0, 1.0
        n, p = self.trials, self.share
        middle = (p + Z**2 / (2 * n)) / (1 + Z**2 / n)
        half = Z / (1 + Z**2 / n) * sqrt(p * (1 - p) / n + Z**2 / (4 * n**2))
        return max(0.0, middle - half), min(1.0, middle + half)

    def __str__(self) -> str:
        if not self.trials:
            return "–"
        low, high = self.interval()
        return f"{100 * self.share:.1f} % ({100 * low:.1f}–{100 * high:.1f}) of {self.trials}"


def rate(marks: list[bool]) -> Rate:
    """The share of true marks."""
    return Rate(sum(marks), len(marks))
