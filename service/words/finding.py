"""Step: a finding of a diagnosis in words and people's units."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10
from typing import Any

from estimator.causes import find
from service.measures import HARD, THIN, amplitude_measure, measured, number
from service.records.model import ModelRevision

Finding = dict[str, Any]
"""One of ``findings`` of imu-diagnosis/1."""
TOLD_APART = 3.0
"""Expected separation below which a proposed measurement would not help."""
SHOWN_SHARE = 5e-4


@dataclass(frozen=True)
class Choice:
    """One of several causes that this session cannot tell apart."""

    cause: str
    name: str
    share: str
    now: str
    """How far it is from the first one in this session."""
    measurement: str
    """What would tell it from the first one."""


@dataclass(frozen=True)
class Bar:
    """One line of the ranking of causes."""

    name: str
    percent: str
    width: float
    """0 to 100."""


@dataclass(frozen=True)
class FindingView:
    """A named cause with its evidence, for people."""

    cause: str
    sentence: str
    doubtful: bool
    advice: str
    amplitudes: tuple[str, ...]
    shape: str
    evidence: str
    choices: tuple[Choice, ...]
    ranking: tuple[Bar, ...]
    parity: str
    since: str
    acceptable: tuple[tuple[str, str], ...]
    """Causes that can become part of a model: identifier and name."""
    sensors: tuple[str, ...]
    accepted: tuple[int, ...]
    """Revisions that already hold it for this session."""


def finding_view(finding: Finding, revisions: Sequence[ModelRevision] = ()) -> FindingView:
    """What a technician and an engineer read of a finding."""
    names = (finding["cause"], *finding["alternatives"])
    return FindingView(
        cause=finding["cause"],
        sentence=finding["sentence"],
        doubtful=bool(finding["alternatives"]),
        advice=finding["advice"],
        amplitudes=_amplitudes(finding),
        shape=shape_in_words(finding),
        evidence=_evidence(finding),
        choices=_choices(finding),
        ranking=_ranking(finding),
        parity=_parity(finding["parity"]),
        since=_since(finding["new"]),
        acceptable=tuple((name, in_words(name)) for name in names if (known := find(name)) and known.can_be_modelled),
        sensors=tuple(finding["sensors"]),
        accepted=tuple(r.id for r in revisions if r.cause in names),
    )


def in_words(identifier: str) -> str:
    """``bias temperature`` of ``bias-temperature``."""
    return identifier.replace("-", " ")


def _amplitudes(finding: Finding) -> tuple[str, ...]:
    """Every amplitude with its standard uncertainty; named by sensor where several share the cause."""
    values, sigmas, units = finding["amplitude"], finding["sigma"], finding["units"]
    each = max(1, len(values) // max(1, len(finding["sensors"])))
    shown = []
    for k, (value, sigma, si_unit) in enumerate(zip(values, sigmas, units, strict=False)):
        if not value and not sigma:
            continue
        unit = amplitude_measure(finding["cause"], si_unit, max(abs(value or 0.0), sigma or 0.0))
        who = f"{finding['sensors'][k // each]}: " if len(finding["sensors"]) > 1 else ""
        which = f"{_part(finding['cause'], k % each)} " if each > 1 else ""
        shown.append(f"{who}{which}{measured(value, sigma, unit)}")
    return tuple(shown)


def _part(cause: str, k: int) -> str:
    """What one of several amplitudes is."""
    known = find(cause)
    return known.amplitude_words[k] if known and known.amplitude_words else f"k{k + 1} ="


def shape_in_words(finding: Finding) -> str:
    """``time constant 812 s``, ``from row 14``; ``A1: from row 14; A2: from row 20`` where they differ."""
    each = finding.get("nonlinear_each", [])  # absent from documents of earlier versions
    if len(each) < 2 or all(one == each[0] for one in each):
        return _one_shape(finding["cause"], finding["nonlinear"])
    shapes = (_one_shape(finding["cause"], one) for one in each)
    return "; ".join(f"{who}: {shape}" for who, shape in zip(finding["sensors"], shapes, strict=False) if shape)


def _one_shape(cause: str, nonlinear: dict[str, float]) -> str:
    parts = []
    for unit, value in nonlinear.items():
        if unit.startswith("row"):
            parts.append(f"row {number(value, 0)}")
        elif unit == "side":
            parts.append("upper side" if value > 0 else "lower side" if value < 0 else "")
        else:
            scaled = amplitude_measure(cause, unit, value)
            parts.append(f"{number(value * scaled.factor)}{THIN}{scaled.label}")
    text = " and ".join(part for part in parts if part)
    known = find(cause)
    return f"{known.shape_words if known else ''} {text}".strip() if text else ""


def _evidence(finding: Finding) -> str:
    return f"{number(finding['strength'], 1)} standard errors; {chance(finding['p_value'])}"


def chance(p_value: float | None) -> str:
    """How often a session with nothing wrong would show as much."""
    if p_value is None:
        return "no probability is known"
    if p_value < 1e-12:
        return "as much by chance in fewer than 1 of 10¹² sound sessions"
    if p_value < 1e-3:
        exponent = str(floor(-log10(p_value))).translate(str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹"))
        return f"as much by chance in fewer than 1 of 10{exponent} sound sessions"
    return f"as much by chance in {number(100 * p_value, 2)}{HARD}% of sound sessions"


def _choices(finding: Finding) -> tuple[Choice, ...]:
    """The named cause and its alternatives, as equals."""
    if not finding["alternatives"]:
        return ()
    shares: dict[str, float] = {}
    for rival in finding["ranking"]:
        shares[rival["cause"]] = shares.get(rival["cause"], 0.0) + rival["probability"]
    apart = {s["cause"]: s for s in finding["separations"]}
    names = (finding["cause"], *finding["alternatives"])
    return tuple(
        Choice(name, cause_on(name, finding["sensors"]), _percent(shares.get(name, 0.0)), *_apart(apart.get(name)))
        for name in names
    )


def _apart(separation: dict[str, Any] | None) -> tuple[str, str]:
    """How far a rival is now, and the measurement that would tell it apart with what to expect of it."""
    if separation is None:
        return "", ""
    now, then = separation["separation"], separation["expected_separation"]
    expected = 0.0 if then is None else then
    if not separation["measurement"] or expected < TOLD_APART:
        return _sigmas(now), "no further session of this kind would tell; look at the hardware"
    return _sigmas(now), f"{separation['measurement']} (expected {_sigmas(expected)} apart)"


def _sigmas(value: float | None) -> str:
    return f"{number(value, 1)}{HARD}σ"


def _ranking(finding: Finding) -> tuple[Bar, ...]:
    """Rival causes with their shares; those that are out of the question are left out."""
    shown = [r for k, r in enumerate(finding["ranking"]) if k < 3 or r["probability"] > SHOWN_SHARE]
    return tuple(
        Bar(cause_on(r["cause"], r["sensors"]), _percent(r["probability"]), 100 * float(r["probability"]))
        for r in shown
    )


def cause_on(cause: str, sensors: Sequence[str]) -> str:
    """``bias temperature (A5)``."""
    return f"{in_words(cause)} ({', '.join(sensors)})" if sensors else in_words(cause)


def _percent(share: float) -> str:
    if share > 0.9995:
        return f"over 99.9{HARD}%"
    return f"{number(100 * share, 1)}{HARD}%" if share > SHOWN_SHARE else f"under 0.1{HARD}%"


def _parity(split: dict[str, Any] | None) -> str:
    """Stand or sensor: what redundancy says."""
    if split is None or any(split.get(k) is None for k in ("parity_before", "parity_after")):
        return ""
    before, after = (number(split[f"parity_{k}"], 0) for k in ("before", "after"))
    if before == after:
        return ""
    seen, left = (number(split[f"range_{k}"], 0) for k in ("before", "after"))
    return (
        f"χ² in parity space {before} → {after}, along the axes {seen} → {left}. "
        "An error of the stand leaves nothing in parity space; a fault of one sensor does."
    )


def _since(new: bool | None) -> str:
    if new is None:
        return ""
    return "New since the earlier sessions." if new else "It was there in the earlier sessions too."
