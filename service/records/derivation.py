"""A unit's accepted sessions as the derivation sees them, and what they tell of flags."""

from dataclasses import dataclass
from datetime import datetime

from service.records.flag import Concern


@dataclass(frozen=True)
class Counted:
    """An accepted session, in short."""

    id: str
    block: str
    programme: str
    at: datetime
    revision: int
    is_reference: bool
    basis: str | None
    """What its verdict rests on; empty where it is to be judged, None where it was judged before this was kept."""


@dataclass(frozen=True)
class Told:
    """What one session tells of its unit's flags: by its verdict, or by its diagnosis."""

    concerns: tuple[Concern, ...]
    clear: tuple[tuple[str, str, str], ...]
    """Matter, place (``*`` is any) and why a flag on it could be resolved."""
