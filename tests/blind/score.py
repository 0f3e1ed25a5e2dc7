"""One case, one diagnosis: was the truth named, listed, measured?"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from tests.blind.case import Case, Truth
from tests.blind.catalogue import DISCRETE, TANGENT
from tests.blind.pose import gravity

UNCOMPARED = DISCRETE | {"excess-noise", "saturation", "sensor-drift"}
"""Amplitudes that have no one agreed meaning: a variance, a limit, what drifted."""
ENTRIES = frozenset({"alpha-entry", "gravity-entry", "latitude-entry"})
"""Entered minus true, or true minus entered: either sign is right."""
SEPARATED = 5.0
FAR = 10.0
"""Separation from every rival beyond which a cause left out of the catalogue must not be given another's name."""


@dataclass(frozen=True)
class Pull:
    """One amplitude's error in units of its own sigma."""

    cause: str
    value: float


@dataclass(frozen=True)
class Outcome:
    """The marks of one case. Everything is plain, so that it crosses processes and prints."""

    label: str
    kind: str
    causes: tuple[str, ...]
    strengths: tuple[float, ...]
    separations: tuple[float, ...]
    rivals: tuple[str, ...]
    findings: tuple[str, ...]
    """Named causes, first first; ``cause@sensors``."""
    alternatives: tuple[str, ...]
    """Every other identifier that the diagnosis offers beside the first name."""
    first: bool
    """The truth is the first finding, on the right sensors."""
    listed: bool
    """The truth is the first finding or one of its alternatives."""
    named: tuple[bool, ...]
    """Whether some finding is each truth."""
    offered: tuple[bool, ...]
    """Whether some finding is each truth or lists it among its alternatives."""
    unexplained: bool
    unexplained_listed: bool
    """Said, or among the alternatives of a name."""
    beliefs: tuple[tuple[float, bool], ...]
    """Every stated probability that a cause acts, and whether it does; of a single effect."""
    pulls: tuple[Pull, ...]
    unstated_noise: bool
    history: int
    seconds: float

    @property
    def separated(self) -> bool:
        """Whether every truth is told apart from every rival."""
        return min(self.separations, default=np.inf) >= SEPARATED

    @property
    def good(self) -> bool:
        """Whether the case went as it should."""
        if self.kind == "none":
            return not self.findings
        if self.kind == "outside":
            return self.unexplained
        if self.kind == "left out":
            return min(self.separations) < FAR or (self.unexplained_listed and not self.findings)
        if self.kind == "two":
            return all(self.named) if self.separated else all(self.offered)
        if self.kind == "weak":
            return self.listed or not self.findings
        return self.first if self.separated else self.listed


def score(case: Case, found: dict[str, Any], seconds: float) -> Outcome:
    """Marks for an ``imu-diagnosis/1`` dictionary."""
    findings = found["findings"]
    first = findings[0] if findings else None
    named = tuple(any(_is(truth, f) for f in findings) for truth in case.truths)
    right = bool(first and any(_is(truth, first) for truth in case.truths))
    offered = first["alternatives"] if first else []
    others = {*offered, *(f["cause"] for f in findings[1:])} - ({first["cause"]} if first else set())
    return Outcome(
        label=case.label,
        kind=case.kind,
        causes=tuple(t.effect.cause for t in case.truths),
        strengths=tuple(t.strength for t in case.truths),
        separations=tuple(t.separation for t in case.truths),
        rivals=tuple(t.nearest.cause if t.nearest else "" for t in case.truths),
        findings=tuple("@".join([f["cause"], "+".join(f["sensors"])]).rstrip("@") for f in findings),
        alternatives=tuple(sorted(others)),
        first=right,
        listed=right or any(t.effect.cause in offered for t in case.truths),
        named=named,
        offered=tuple(
            ok or any(t.effect.cause in f["alternatives"] for f in findings)
            for t, ok in zip(case.truths, named, strict=True)
        ),
        unexplained=bool(found["unexplained"]),
        unexplained_listed=bool(found["unexplained"]) or any("unexplained" in f["alternatives"] for f in findings),
        beliefs=tuple(belief for f in findings for belief in beliefs(case, f)),
        pulls=tuple(p for t in case.truths for f in findings if _is(t, f) for p in pulls(t, f, case)),
        unstated_noise=not case.world.noise.stated,
        history=len(case.history),
        seconds=seconds,
    )


def _is(truth: Truth, finding: dict[str, Any]) -> bool:
    """Whether a finding is the truth: its cause, on its sensors."""
    return truth.effect.cause == finding["cause"] and set(truth.names) == set(finding["sensors"])


def beliefs(case: Case, finding: dict[str, Any]) -> list[tuple[float, bool]]:
    """The probabilities of a finding's ranking, each with whether it is of the truth; none where there are two."""
    if case.kind not in ("single", "weak"):
        return []
    (truth,) = case.truths
    return [(r["probability"], _is(truth, r)) for r in finding.get("ranking", [])]


def pulls(truth: Truth, finding: dict[str, Any], case: Case) -> list[Pull]:
    """(estimate − truth)/sigma of every amplitude that can be compared; a length for tangent components."""
    cause, true = truth.effect.cause, np.array(truth.effect.amplitude)
    if cause in UNCOMPARED or not truth.comparable:
        return []
    value, sigma = (np.array(finding[key], dtype=float)[: len(true)] for key in ("amplitude", "sigma"))
    if len(value) < len(true):
        return []
    if cause in TANGENT:
        length = np.linalg.norm(value)
        spread = np.sqrt(np.sum((value * sigma) ** 2)) / length
        return [Pull(cause, float((length - np.linalg.norm(true)) / spread))]
    meanings = [true]
    if cause in ENTRIES:
        meanings = [true, -true]
    if cause == "gravity-entry":
        meanings = [m * unit for m in meanings for unit in (1.0, gravity(case.world.site))]
    misses = [(value - m) / sigma for m in meanings]
    nearest = min(misses, key=lambda miss: float(np.abs(miss).max()))
    return [Pull(cause, float(x)) for x in nearest]
