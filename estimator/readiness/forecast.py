"""Draws a course's largest departure from its present value during a programme, from its posterior."""

from dataclasses import dataclass

import numpy as np

from estimator.readiness.course import SettlingCourse
from estimator.session import Array

DRAWS = 2000
"""Draws of the posterior: a chance of 5 % is then known to half a per cent."""
STEPS = 12
"""Points of a programme at which the departure is looked at."""
WAITS = np.concatenate([[0.0], np.geomspace(60.0, 8 * 3600.0, 48)])
"""s that one may wait: a minute to a working day."""
LIKELY = 0.95
"""Probability with which the drift to come must be allowed."""


@dataclass(frozen=True, eq=False)
class DrawnDrift:
    """N courses of one sensor."""

    span: float
    """s."""
    drift: Array
    """(N,) d, m/s² or rad/s over the record."""
    settling: Array
    """(N, 2) a, m/s² or rad/s."""
    tau: Array
    """(N, 2) s."""
    walk: Array
    """(N,) one sigma of the walk over the record, m/s² or rad/s."""

    def to_come(self, after: float, duration: float) -> Array:
        """(N, STEPS) change of the course, without walk, from ``after`` s beyond the record on, m/s² or rad/s."""
        s = duration * np.arange(1, STEPS + 1) / STEPS
        remaining = self.settling * np.exp(-(self.span + after) / self.tau)
        settles = [remaining[:, [j]] * -np.expm1(-s / self.tau[:, [j]]) for j in range(2)]
        return np.asarray(self.drift[:, None] * s / self.span + sum(settles))


def drawn(course: SettlingCourse, rng: np.random.Generator) -> DrawnDrift:
    """Courses as likely as the record leaves them."""
    cell = rng.choice(len(course.weight), DRAWS, p=course.weight)
    sigma = np.sqrt(course.scatter[cell] / rng.chisquare(course.freedom, DRAWS))
    normal = rng.standard_normal((DRAWS, 3))
    parts = course.mean[cell] + sigma[:, None] * np.einsum("nij,nj->ni", course.root[cell], normal)
    return DrawnDrift(course.span, parts[:, 0], parts[:, 1:], course.tau[cell], sigma * np.sqrt(course.walk[cell]))


def departures(courses: DrawnDrift, duration: float, rng: np.random.Generator) -> Array:
    """(N,) largest departure from the present value during the programme, the walk included, m/s² or rad/s."""
    step = courses.walk * np.sqrt(duration / STEPS / courses.span)
    walks = np.cumsum(rng.standard_normal((len(step), STEPS)), axis=1) * step[:, None]
    return np.asarray(np.abs(courses.to_come(0.0, duration) + walks).max(axis=1))


def wait(courses: DrawnDrift, duration: float, allowed: float) -> tuple[float, float, float] | None:
    """s until the course without walk stays within ``allowed``: 5, 50, 95 %; None where most never do."""
    until = np.full(len(courses.drift), np.inf)
    for after in WAITS[::-1]:
        within = np.abs(courses.to_come(float(after), duration)).max(axis=1) <= allowed
        until[within] = after
    low, middle, high = np.quantile(until, [0.05, 0.5, 0.95], method="lower")
    return (float(low), float(middle), float(high)) if np.isfinite(middle) else None
