"""What the simulation gets wrong about the session, as the paper says it."""

from dataclasses import dataclass

from estimator.message import joined, say
from service.diagnosis.words.finding import FindingView, finding_view
from service.papers.certified import CertifiedSession


@dataclass(frozen=True)
class Cause:
    """What the simulation gets wrong about the session, named."""

    sentence: str
    amplitudes: str
    evidence: str
    alternatives: str
    """Causes that this session cannot tell from it."""
    corrected: str
    """Whether the calibration takes it into account; empty of one that is no part of a model."""


def causes_of(found: CertifiedSession) -> tuple[Cause, ...]:
    """The findings of the diagnosis, in their order; none where there is no diagnosis yet."""
    diagnosis = found.diagnosis.found
    findings = () if diagnosis is None else diagnosis.findings
    views = (finding_view(finding, found.revisions, findings) for finding in findings)
    return tuple(
        Cause(
            sentence=view.sentence,
            amplitudes=joined("; ", (part for part in (*view.amplitudes, view.shape) if part)),
            evidence=view.evidence,
            alternatives=joined(", ", (choice.name for choice in view.choices)),
            corrected=_corrected(view),
        )
        for view in views
    )


def _corrected(view: FindingView) -> str:
    if view.accepted:
        return say("Taken into account by model revision {accepted}.", accepted=max(view.accepted))
    return "Not taken into account by the numbers of this certificate." if view.acceptable else ""
