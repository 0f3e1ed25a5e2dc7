"""What the fleet page says before its list of units."""

from dataclasses import dataclass

from service.records.group import FoundTogether
from service.records.stand import StandCondition
from service.records.state import Questioned


@dataclass(frozen=True)
class Announced:
    """What concerns many units, or waits for somebody."""

    stands: tuple[StandCondition, ...]
    """That shift every unit measured on them, or did, by name."""
    questioned: tuple[Questioned, ...]
    """Sessions that wait for an engineer, the latest first."""
    found: tuple[FoundTogether, ...]
    """What sessions show together: of stands before types before units."""
    groups: int
    """How many groups show something, those that are not named too."""
