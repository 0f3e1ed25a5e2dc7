"""One group, one diagnosis: was the truth named, at its level, listed, measured?"""

from collections import Counter
from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.blind.catalogue import TANGENT
from tests.blind.groups import Group, GroupTruth


@dataclass(frozen=True)
class GroupOutcome:
    """The marks of one group."""

    label: str
    level: str
    kind: str
    form: str
    misstated: bool
    causes: tuple[str, ...]
    pooled: tuple[float, ...]
    separations: tuple[float, ...]
    largest: float
    """Strength in the session that shows it most."""
    findings: tuple[str, ...]
    first: bool
    """The truth is the first finding, on the right sensors, at the right level."""
    named: tuple[bool, ...]
    listed: tuple[bool, ...]
    alternatives: int
    forms: tuple[str, ...]
    """Form that each truth was found as."""
    pulls: tuple[float, ...]
    unexplained: bool
    terms: int
    sure: bool
    """Whether something has a name, and nothing is reported without one."""
    doubted: bool
    """The first finding may as well be something outside the catalogue."""
    crowd: int
    """Most names on one sensor."""

    @property
    def clear(self) -> bool:
        """Strong on the pool, told apart, and in no session by itself."""
        return min(self.pooled) >= 8 and min(self.separations) >= 5 and self.largest <= 3.5


def score(group: Group, found: dict[str, Any], misstated: bool = False) -> GroupOutcome:
    """Marks for an ``imu-fleet-diagnosis/1`` dictionary."""
    findings = found["findings"]
    named = [next((f for f in findings if is_it(t, f)), None) for t in group.truths]
    return GroupOutcome(
        label=group.label,
        level=group.level,
        kind=group.kind,
        form=group.truths[0].form if group.truths else "",
        misstated=misstated,
        causes=tuple(t.effect.cause for t in group.truths),
        pooled=tuple(t.pooled for t in group.truths),
        separations=tuple(t.separation for t in group.truths),
        largest=max((max(t.strengths) for t in group.truths), default=0.0),
        findings=tuple(f"{f['cause']}@{'+'.join(f['sensors'])}/{f['level']}" for f in findings),
        first=bool(findings) and any(is_it(t, findings[0]) for t in group.truths),
        named=tuple(n is not None for n in named),
        listed=tuple(n is not None or is_listed(t, findings) for t, n in zip(group.truths, named, strict=True)),
        alternatives=max((len(f["rivals"]) for f in findings), default=0),
        forms=tuple("" if n is None else n["form"] for n in named),
        pulls=tuple(p for t, n in zip(group.truths, named, strict=True) if n is not None for p in pulls(t, n)),
        unexplained=bool(found["unexplained"]),
        terms=len(found["terms"]),
        sure=not found["unexplained"] and any("unexplained" not in f["alternatives"] for f in findings),
        doubted=bool(findings) and "unexplained" in findings[0]["alternatives"],
        crowd=max(Counter(sensor for f in findings for sensor in f["sensors"]).values(), default=0),
    )


def is_it(truth: GroupTruth, finding: dict[str, Any]) -> bool:
    """Whether a finding is the truth: its cause, its sensors, its level."""
    return (
        truth.effect.cause == finding["cause"]
        and truth.level == finding["level"]
        and truth.subject == finding["subject"]
        and set(truth.names) == set(finding["sensors"])
    )


def is_listed(truth: GroupTruth, findings: list[dict[str, Any]]) -> bool:
    """Whether some finding lists the truth's cause among what it cannot be told from, or names it at another level."""
    return any(
        truth.effect.cause == f["cause"] or any(truth.effect.cause == r["cause"] for r in f["rivals"]) for f in findings
    )


def pulls(truth: GroupTruth, finding: dict[str, Any]) -> list[float]:
    """(estimate − truth)/sigma of every amplitude that can be compared; a length for tangent components."""
    if None in finding["sigma"]:
        return []
    value, sigma = np.array(finding["amplitude"]), np.array(finding["sigma"])
    true = np.array(truth.effect.amplitude)
    if finding["shape"] is not None or len(value) != len(true):
        return []
    if truth.effect.cause in TANGENT:
        length = float(np.linalg.norm(value))
        spread = float(np.sqrt(np.sum((value * sigma) ** 2))) / length
        return [(length - float(np.linalg.norm(true))) / spread]
    return [float(p) for p in (value - true) / sigma]
