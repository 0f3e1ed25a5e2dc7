"""A factor that all readings of a kind share since the history, and that the applied vector cannot have made.

A supply voltage, the reference of a converter or a range setting scales all sensors that it reads at once. Beyond what
gravity can do (`common_factors`) that is neither an entry of the record nor the drift of one sensor, and from some
percent on nothing is linear in it. So the history is brought to the scale of the session, and the factor is said: then
what else happened is looked for as always. An earlier session that was measured under another factor than the rest
says nothing against a later one that agrees with them.

x is the median of the sensors' ln K − ln K of the history; it is common where three in four of them have it, to a tenth
of it or to three standard errors, and beyond the bounds at the level of 1 in 10,000. A wrong elevation of the stand
changes scale factors too, not all alike and not without the axes: up to a tenth the catalogue is asked first, and only
what it takes for gravity and gravity cannot be is brought to one scale.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from estimator.applied_vector import common_factors
from estimator.causes.contract import Cause
from estimator.diagnosis.record.clipping import earlier_baseline
from estimator.diagnosis.residuals.baseline import Baseline
from estimator.session import Array
from estimator.significance import p_value

FEWEST = 3
"""Sensors that it takes to tell a common factor from a change of one: of two either may have changed."""
MOST = 0.75
"""Share of the sensors that have it: of three all, of four one may have changed by itself."""
LARGE = 0.1
"""Relative, from which on signatures are not linear in it, and no entry of an elevation does it to three in four
sensors without turning axes beyond what a record can hold (`implausible`)."""
ALIKE = 0.1
"""Part of the factor within which sensors have it: single changes as alike as that by chance are rare."""
NOISE = 3.0
"""Standard errors of a sensor's own change within which it agrees."""
LEVEL = 1e-4
"""Level for one pair of sessions: ten earlier sessions then cost a tenth of the 1 % error of a whole diagnosis."""


@dataclass(frozen=True)
class CommonScale:
    """A change that all scale factors of one kind of sensor share since the latest earlier session."""

    kind: str
    sensors: tuple[int, ...]
    factor: float
    """Relative change."""
    sigma: float
    p_value: float
    """Chance of one as far beyond the bounds."""


def on_one_scale(
    now: Baseline, history: Sequence[Baseline], catalogue: tuple[Cause, ...], least: float = LARGE
) -> tuple[tuple[CommonScale, ...], tuple[Baseline, ...]]:
    """The common factors of ``least`` size, relative, that all of the history shows; and the history without these and
    without those that a part of it has."""
    alike = [h.setting.kinds == now.setting.kinds for h in history]
    found = [
        {scale.kind: scale for scale in common_scales(now, h)} if same else {}
        for same, h in zip(alike, history, strict=True)
    ]
    whole = [f for f, same in zip(found, alike, strict=True) if same]
    lasting = [scale for kind, scale in whole[-1].items() if all(kind in f for f in whole)] if whole else []
    left = [scale.kind for scale in lasting if abs(scale.factor) < least]
    taken = [[scale for kind, scale in f.items() if kind not in left] for f in found]
    scaled = [rescaled(h, f, catalogue) if f else h for h, f in zip(history, taken, strict=True)]
    return tuple(scale for scale in lasting if scale.kind not in left), tuple(scaled)


def is_one_place(now: Baseline, history: Sequence[Baseline]) -> bool:
    """Whether all sessions of the history state the place of this one."""
    return all(h.session.site == now.session.site for h in history)


def common_scales(now: Baseline, earlier: Baseline) -> Iterator[CommonScale]:
    """The factors beyond what the applied vector can do between two sessions of like sensors, kind by kind."""
    ratio = now.parameters.scale / earlier.parameters.scale
    covariance = (now.covariance_between + earlier.covariance_between)[::5, ::5]
    for kind in dict.fromkeys(now.setting.kinds):
        sensors = np.array([i for i, k in enumerate(now.setting.kinds) if k == kind])
        if len(sensors) < FEWEST or not (ratio[sensors] > 0).all():
            continue
        changes, of_kind = np.log(ratio[sensors]), covariance[np.ix_(sensors, sensors)]
        x, sigma = float(np.median(changes)), float(np.sqrt(of_kind.mean()))
        bounds = np.log1p(common_factors(kind, now.session.site, earlier.session.site))
        chance = float(p_value(((x - np.clip(x, *bounds)) / sigma) ** 2, 1))
        within = np.maximum(ALIKE * abs(x), NOISE * np.sqrt(np.diagonal(of_kind)))
        if chance < LEVEL and np.mean(np.abs(changes - x) < within) >= MOST:
            yield CommonScale(kind, tuple(sensors.tolist()), float(np.expm1(x)), sigma, chance)


def rescaled(earlier: Baseline, scales: Sequence[CommonScale], catalogue: tuple[Cause, ...]) -> Baseline:
    """An earlier session as it would have been read on the scale of now."""
    session = earlier.session
    factors: Array = np.ones(len(session.sensors))
    for scale in scales:
        factors[list(scale.sensors)] += scale.factor
    zero = np.array([sensor.nominal_offset or 0.0 for sensor in session.sensors])
    readings, errors = zero + factors * (session.readings - zero), factors * session.standard_errors
    return earlier_baseline(replace(session, readings=readings, standard_errors=errors), catalogue)
