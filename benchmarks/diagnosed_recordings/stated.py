"""Whatever the errors are stated as: every group diagnosed from its log and from means with errors × ⅓, × 1 and × 3."""

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from benchmarks.diagnosed_recordings.groups import SETS, Group
from benchmarks.diagnosed_recordings.words import many, table
from estimator import diagnose
from estimator.diagnosis import Finding
from estimator.diagnosis.results import Diagnosis
from estimator.errors import ScheduleError
from estimator.session import CalibrationSession

FACTORS = {"⅓": 1 / 3, "1": 1.0, "3": 3.0}
"""Factors on the stated errors, as an honest person is wrong who forgets that noise is correlated, or allows for too
much.
"""

ALIKE = 0.02
"""Probabilities nearer than this are the same: rounding of a fit that starts from other weights."""

HEAD = ("recording", "sensors", "input", "× ⅓", "× 1", "× 3", "stated noise", "structures")


@dataclass(frozen=True)
class Answer:
    """The answer to one input."""

    names: tuple[tuple[str, frozenset[str]], ...]
    """Causes with their sensors, in alphabetical order."""
    probabilities: tuple[float, ...]
    words: str
    noise: str
    structures: int

    def like(self, other: "Answer") -> bool:
        """Whether both give the same names with the same probabilities."""
        pairs = zip(self.probabilities, other.probabilities, strict=False)
        return self.names == other.names and all(abs(p - q) < ALIKE for p, q in pairs)


def answer(diagnosis: Diagnosis) -> Answer:
    """The answer of a diagnosis, names in a fixed order."""
    findings = sorted(diagnosis.findings, key=lambda f: (f.cause, f.sensors))
    chances = tuple(probability(f) for f in findings)
    named = [f"`{f.cause}`{many(f)} {p:.0%}" for f, p in zip(findings, chances, strict=True)]
    return Answer(
        names=tuple((f.cause, frozenset(f.sensors)) for f in findings),
        probabilities=chances,
        words="; ".join(named) or "none",
        noise=", ".join(f"{n.kind[0].upper()} {n.factor:.2g}" for n in diagnosis.noise) or "right",
        structures=len(diagnosis.structures),
    )


def probability(finding: Finding) -> float:
    """Probability of the named cause in its own ranking; 1 where it has no rivals."""
    return next((r.probability for r in finding.ranking if r.cause == finding.cause), 1.0)


def line(group: Group, words: str, sessions: Iterable[CalibrationSession]) -> tuple[str, ...]:
    """A row of the table: the names of every session of one input."""
    try:
        found = [answer(diagnose(s)) for s in sessions]
    except ScheduleError as error:
        return group.recording, group.words, words, f"refused: {error.problems[0].field}", *[""] * 4
    middle = found[len(found) // 2]
    names = [a.words if a is middle else "the same" if a.like(middle) else f"**{a.words}**" for a in found]
    told = [each([a.noise for a in found]), each([str(a.structures) for a in found])]
    shown = names if len(names) > 1 else ["", *names, ""]
    return group.recording, group.words, words, *shown, *told


def each(said: list[str]) -> str:
    """The answer at every factor; once where it is the same."""
    return said[0] if len(set(said)) == 1 else " / ".join(said)


def lines(group: Group) -> Iterator[tuple[str, ...]]:
    """The rows of one group."""
    if group.log is not None:
        yield line(group, "log", [group.log])
    errors = group.means.standard_errors
    yield line(group, "means", [replace(group.means, standard_errors=f * errors) for f in FACTORS.values()])


def stated_table() -> str:
    """The table, Markdown: inputs of which something is named."""
    body = []
    for groups in SETS:
        for group in groups():
            body += [row for row in lines(group) if any("`" in cell for cell in row[3:6])]
            print(f"{group.recording}, {group.words}", file=sys.stderr)
    return table(HEAD, body)
