"""May a unit be used?"""

from dataclasses import dataclass

from service.records.answer import answer
from service.records.usable import Usable


@answer
@dataclass(frozen=True)
class UsableAnswer(Usable):
    """The one question of a ground computer, answered."""

    correction: str | None
    """Address of the correction that firmware applies."""
