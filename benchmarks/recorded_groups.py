"""``python -m benchmarks.recorded_groups``: the public recordings as groups, as docs/diagnosis/groups.md states them.

A session left out: the group without it is diagnosed, its findings are taken out of the session at their size, and the
χ² per degree of freedom of what is left is held against that of the plain calibration.
"""

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np

from benchmarks.diagnosed_recordings.groups import accelerometers, gyros, some
from benchmarks.recordings.sets import recordings
from estimator import calibrate, diagnose_group
from estimator.groups import GroupFinding
from estimator.groups.fixed import calibrate_with, fixed
from estimator.results import Calibration
from estimator.session import CalibrationSession

TRIADS = 8
"""Number of triads on the sensor array's board."""
LEVELS = ("unit", "type")


@dataclass(frozen=True, eq=False)
class Recorded:
    """Sessions that belong together."""

    title: str
    level: str
    sessions: Sequence[CalibrationSession]


def groups() -> Iterator[Recorded]:
    """The groups that a person would make of the recordings."""
    array = [r.session for r in recordings("kth-mimu")]
    for words, names in (("accelerometers", accelerometers(array[0], TRIADS)), ("gyros", gyros(array[0]))):
        if names:
            own = [replace(dated(some(s, names), k), unit="array") for k, s in enumerate(array)]
            yield Recorded(f"array of eight triads, {words}", "unit", own)
    five = [r.session for r in recordings("mpu9150-five")][:5]
    for words, chosen in (("accelerometers", accelerometers), ("gyros", lambda s, _: gyros(s))):
        own = [dated(named(some(s, chosen(s, 1)), k), k) for k, s in enumerate(five)]
        if own[0].sensors:
            yield Recorded(f"five MPU-9150, {words}", "type", own)


def dated(session: CalibrationSession, number: int) -> CalibrationSession:
    """The session with a date, where its recording states none: a group is ordered by date."""
    return replace(session, started_at=session.started_at or f"2014-01-{number + 1:02d}T00:00:00Z")


def named(session: CalibrationSession, number: int) -> CalibrationSession:
    """One of several units of a type, its sensors called as those of the others."""
    sensors = tuple(replace(s, name=f"{s.kind[0].upper()}{i + 1}") for i, s in enumerate(session.sensors))
    return replace(session, unit=f"mpu9150-{number + 1}", unit_type="MPU-9150", sensors=sensors)


def per_freedom(found: Calibration) -> float:
    """χ² per degree of freedom."""
    return found.fit.chi2 / max(found.fit.dof, 1)


def left_out(group: Recorded, k: int) -> tuple[float, float] | None:
    """χ² per degree of freedom of one session without and with what the others show; None where they show nothing."""
    others = [s for j, s in enumerate(group.sessions) if j != k]
    own = group.sessions[k]
    found = [f for f in diagnose_group(others, group.level).findings if f.subject in (own.unit, own.unit_type)]
    if not found:
        return None
    return per_freedom(calibrate(own)), per_freedom(calibrate_with(own, [fixed(f) for f in found]))


def words_of(finding: GroupFinding) -> str:
    """A finding as the page's table has it."""
    sizes = ", ".join(
        f"{a:.3g} ± {2 * s:.1g}" for a, s in zip(finding.amplitude, finding.sigma, strict=True) if s is not None
    )
    on = f" ({', '.join(finding.sensors)})" if finding.sensors else ""
    others = f", or {', '.join(finding.alternatives)}" if finding.alternatives else ""
    form = f"since {finding.since}" if finding.since else finding.form
    return f"`{finding.cause}`{on} of {finding.level} {finding.subject}, {form}: {sizes} {finding.units[0]}{others}"


def main() -> None:
    """Print a line a group."""
    print("| group | sessions | found | a session left out, χ² per freedom |\n| --- | --- | --- | --- |")
    for group in groups():
        found = diagnose_group(group.sessions, group.level)
        names = "; ".join(map(words_of, found.findings)) or "nothing"
        terms = "".join(f"; learned: {t.equation}" for t in found.terms)
        structure = "; structure that no cause explains" if found.unexplained else ""
        each = [left_out(group, k) for k in range(len(group.sessions))]
        gain = "; ".join("nothing found" if one is None else f"{one[0]:.3g} → {one[1]:.3g}" for one in each)
        print(f"| {group.title} | {len(group.sessions)} | {names}{structure}{terms} | {gain} |", flush=True)


if __name__ == "__main__":
    np.seterr(all="raise", under="ignore")
    main()
