"""One session as the folder gives it, and the claims of a method about it."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from benchmarks.blind.folder import SESSION
from benchmarks.study.signatures import Signatures
from estimator import CalibrationSession, calibrate, read_session
from estimator.causes.catalogue import CATALOGUE
from estimator.diagnosis.diagnose import PutRight, initial_state, put_right
from estimator.diagnosis.explanation.record_findings import clip_findings, entry_finding, record_error_finding
from estimator.diagnosis.posterior.explained import ExplainedSession
from estimator.diagnosis.record.nominal import WrongEntry, wrong_entry
from estimator.diagnosis.residuals.fitted import baseline_of
from estimator.diagnosis.results import Finding

SAID = ("cause", "sensors", "amplitude", "sigma", "alternatives")
"""Fields of a finding that an answer holds."""


class Claim(NamedTuple):
    """One statement about a session."""

    statistic: float
    """The larger, the surer; on a scale of the method's own."""
    finding: dict[str, Any] | None
    """The finding as an answer holds it; None: structure that no cause explains."""


@dataclass(frozen=True, eq=False)
class Given:
    """A session and its history, oldest first."""

    session: CalibrationSession
    history: tuple[CalibrationSession, ...]

    @classmethod
    def of(cls, own: Path) -> "Given":
        """Reads the session from its folder."""
        return cls(read_session(own / SESSION), tuple(read_session(h) for h in sorted(own.glob("history-*.json"))))

    @cached_property
    def right(self) -> PutRight:
        """The session with its record corrected."""
        return put_right(self.session, self.history, CATALOGUE)

    @cached_property
    def entry(self) -> WrongEntry | None:
        """An entry that the nominal axes show to be wrong; None where it is right, or a history tells."""
        return None if self.history else wrong_entry(self.right.right.session, CATALOGUE)

    @cached_property
    def state(self) -> ExplainedSession:
        """Residuals of the session put right, nothing sought in them yet."""
        baseline = (
            self.right.right if self.entry is None else baseline_of(self.entry.corrected(self.right.right.session))
        )
        return initial_state(baseline, self.right.earlier, CATALOGUE)

    @cached_property
    def signatures(self) -> Signatures:
        """All signatures in these residuals."""
        return Signatures.of(self.state)

    def of_record(self) -> Iterator[Finding]:
        """Findings about the record, which was corrected."""
        yield from clip_findings(self.right.clips, self.right.rows, self.state.baseline, calibrate(self.right.rows))
        yield from (record_error_finding(error, self.right.rows) for error in self.right.errors)
        if self.entry is not None:
            yield entry_finding(self.entry)


def said(finding: Finding) -> dict[str, Any]:
    """A finding as an answer holds it."""
    return {name: getattr(finding, name) for name in SAID}
