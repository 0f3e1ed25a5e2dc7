"""Step: at how many °C a session was measured, beside those that its unit's reference and earlier sessions cover.

A verdict compares a session with the unit's reference. What temperature does to a sensor is in the difference, as is
what the sensor did by itself. It is known to be little where an earlier session at such a temperature was within
tolerance, and where the earlier sessions span temperature they tell how much it is.
"""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from estimator.diagnosis.explanation.temperature import LEAST_DIFFERENCE
from estimator.health.detection import LEVEL, Warmth, warmed
from estimator.health.fits import Readings
from estimator.health.prognosis import Track
from estimator.results import Residuals
from service.judging.cause_sizes import Size
from service.outlook.rules.histories import TrackKey, histories
from service.outlook.store import ChangeRow, ReferenceRow
from service.sessions.decision import Verdict
from service.sessions.records import StoredSession

WITHIN = (Verdict.PASS, Verdict.CONDITIONAL_PASS)
"""Verdicts by which temperature did not do much."""


@dataclass(frozen=True, eq=False)
class Covered:
    """What is known of a unit and temperature."""

    lowest: float
    highest: float
    reference: float
    """°C of the session that others are judged against, its mean."""
    now: float
    """Of the session."""
    changes: tuple[ChangeRow, ...] = ()
    """Of earlier sessions, where the session lies outside."""
    references: tuple[ReferenceRow, ...] = ()

    @property
    def outside(self) -> float:
        """°C by which the session lies outside; below zero where colder."""
        return self.now - float(np.clip(self.now, self.lowest, self.highest))

    @property
    def is_far(self) -> bool:
        """Whether it was measured at another temperature."""
        return abs(self.outside) > LEAST_DIFFERENCE


def covered_by(session: StoredSession, reference: Residuals, earlier: Iterable[StoredSession]) -> Covered | None:
    """The temperatures that a reference and earlier sessions cover; None where nothing says them."""
    if session.temperature is None or reference.temperature is None:
        return None
    own = np.asarray(reference.temperature)
    passed = [s.temperature for s in earlier if s.temperature is not None and s.verdict in WITHIN]
    every = np.array([*own, *passed])
    return Covered(float(every.min()), float(every.max()), float(own.mean()), session.temperature)


def worth_of(covered: Covered) -> tuple[Size, ...] | None:
    """What the step in temperature is worth in every parameter, by the earlier sessions; None where they do not tell.

    It goes on in a straight line beyond the temperatures that they span.
    """
    known = histories(covered.changes, covered.references)
    laws = [_law(track) for track in known.tracks]
    if not laws or any(law is None for law in laws):
        return None
    step = abs(covered.now - covered.reference)
    each = zip(known.keys, known.tracks, laws, strict=True)
    return tuple(_size(key, track.tolerance, law, step) for key, track, law in each if law is not None)


def _law(track: Track) -> Warmth | None:
    if track.temperature is None or track.dof is None:
        return None
    n, allowed = len(track.time), track.tolerance
    changes = Readings(track.time, track.change / allowed, track.sigma / allowed, np.ones((n, 1)), np.ones(1))
    return warmed(changes, 0.0, track.dof, track.temperature, LEVEL).warmth


def _size(key: TrackKey, tolerance: float, law: Warmth, step: float) -> Size:
    value, sigma = float(np.linalg.norm(law.coefficient)), float(law.sigma.max())
    return Size((key.sensor,), key.kind, key.parameter, value * step * tolerance, sigma * step * tolerance, tolerance)
