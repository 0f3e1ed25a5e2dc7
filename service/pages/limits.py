"""What a session would have found, and what it cannot see."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from service.measures import THIN, amplitude_measure, number
from service.words.finding import in_words


@dataclass(frozen=True)
class LimitRow:
    """The smallest effect of one cause that would have been found."""

    cause: str
    amplitude: str


@dataclass(frozen=True)
class BlindRow:
    """Causes that the session cannot see, and why."""

    reason: str
    causes: str


@dataclass(frozen=True)
class LimitsView:
    """Detection limits in people's units."""

    seen: tuple[LimitRow, ...]
    blind: tuple[BlindRow, ...]


def limits_view(limits: Sequence[dict[str, Any]]) -> LimitsView:
    """Visible causes with their limits, then the others by reason."""
    blind: dict[str, list[str]] = {}
    for limit in limits:
        if limit["amplitude"] is None:
            blind.setdefault(limit["reason"], []).append(in_words(limit["cause"]))
    return LimitsView(
        seen=tuple(LimitRow(in_words(e["cause"]), _amplitude(e)) for e in limits if e["amplitude"]),
        blind=tuple(BlindRow(reason or "not seen", ", ".join(causes)) for reason, causes in blind.items()),
    )


def _amplitude(limit: dict[str, Any]) -> str:
    """Every amplitude once: two that agree to a tenth are one number."""
    shown: list[str] = []
    for value, si_unit in zip(limit["amplitude"], limit["units"], strict=False):
        if value is None:
            continue
        unit = amplitude_measure(limit["cause"], si_unit, value)
        text = f"{number(float(f'{value * unit.factor:.2g}'))}{THIN}{unit.label}"
        if text not in shown:
            shown.append(text)
    return "; ".join(shown) or "–"
