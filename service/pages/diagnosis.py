"""The page of a diagnosis, "What the simulation gets wrong": the cause and what to do first, then the evidence."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from service.charts import ChartSet
from service.charts.diagnosis import MOST_PANELS, Sides, diagnosis_charts
from service.judging.model_in_force import in_force
from service.measures import number
from service.pages.gain import GainView, gain_view
from service.pages.limits import LimitsView, limits_view
from service.pages.residual_table import ResidualTable, residual_table
from service.records.diagnosis import DiagnosisReport, DiagnosisState
from service.records.model import ModelRevision, Scope
from service.records.session import StoredSession
from service.words.diagnosis import listed
from service.words.finding import FindingView, cause_on, chance, finding_view, in_words

PENDING = "Still being found out"
HEADLINES = {
    DiagnosisState.NOTHING: "Nothing wrong found",
    DiagnosisState.UNDECIDED: "Cannot tell which",
    DiagnosisState.UNEXPLAINED: "Something is there that no known cause explains",
    DiagnosisState.FAILED: "This session cannot be diagnosed",
    DiagnosisState.NOT_APPLICABLE: "Not applicable to this programme",
}
"""A named cause speaks for itself."""
TONES = {
    DiagnosisState.NOTHING: "pass",
    DiagnosisState.NAMED: "conditional-fail",
    DiagnosisState.UNDECIDED: "undecidable",
    DiagnosisState.UNEXPLAINED: "undecidable",
    DiagnosisState.FAILED: "none",
    DiagnosisState.NOT_APPLICABLE: "none",
}
"""Style and icon, in the tones of the verdicts: how much it asks for attention."""
SOUND = "Measurement and simulation agree within the noise: no cause of the catalogue and no other structure shows."
CHOOSE = "This session cannot tell these causes apart. Measure what would separate them before acting on one."
UNKNOWN = "Do not force a name on it: look where it lives, repeat the session, and compare with another unit or stand."
REFRESH_SECONDS = 3


@dataclass(frozen=True)
class StructureView:
    """Structure without a name, and where it lives."""

    where: str
    who: str
    evidence: str


@dataclass(frozen=True)
class RevisionView:
    """An accepted cause that concerns the session."""

    revision: ModelRevision
    name: str
    subject: str
    state: str
    """What it is to this session's calibration."""
    withdrawn: ModelRevision | None
    """The revision that withdrew it."""


@dataclass(frozen=True)
class DiagnosisPage:
    """Everything the page shows."""

    session: StoredSession
    tone: str
    headline: str
    what_to_do: str
    pending: bool
    findings: tuple[FindingView, ...]
    structures: tuple[StructureView, ...]
    charts: tuple[ChartSet, ...]
    both_models: bool
    beta: bool
    left_out: int
    """Sensors that are not drawn."""
    residuals: ResidualTable | None
    gain: GainView | None
    limits: LimitsView | None
    notes: tuple[str, ...]
    revisions: tuple[RevisionView, ...]
    scopes: tuple[tuple[str, str], ...]
    made: str


def diagnosis_page(report: DiagnosisReport) -> DiagnosisPage:
    """The page of a session's diagnosis, pending or made."""
    found, session = report.diagnosis, report.session
    document = None if found is None else found.document
    page = DiagnosisPage(
        session=session,
        tone="none" if found is None else TONES[found.state],
        headline=PENDING if found is None else HEADLINES.get(found.state, found.summary),
        what_to_do="A large session takes some seconds; this page reads itself again." if found is None else "",
        pending=found is None,
        findings=(), structures=(), charts=(), both_models=False, beta=False, left_out=0,
        residuals=None, gain=None, limits=None, notes=(),
        revisions=tuple(_revision(r, session, report.revisions) for r in report.revisions if r.withdraws is None),
        scopes=_scopes(session),
        made="" if found is None else f"Made by estimator {found.estimator_version}",
    )  # fmt: skip
    if found is None:
        return page
    if document is None or found.state is DiagnosisState.NOT_APPLICABLE:
        return replace(page, what_to_do=found.summary)
    return _with_evidence(page, report, document)


def _with_evidence(page: DiagnosisPage, report: DiagnosisReport, document: dict[str, Any]) -> DiagnosisPage:
    found, before, after = report.diagnosis, report.before, report.after
    assert found is not None
    assert before is not None
    assert after is not None
    named = [sensor for part in (*document["findings"], *document["structures"]) for sensor in part["sensors"]]
    sides = Sides(after.sensors, before, after.residuals if document["findings"] else None)
    findings = tuple(finding_view(f, in_force(report.revisions)) for f in document["findings"])
    return replace(
        page,
        headline=_headline(page.headline, findings),
        what_to_do=_what_to_do(found.state, findings),
        findings=findings,
        structures=_structures(document["structures"]),
        charts=diagnosis_charts(sides, named),
        both_models=sides.after is not None,
        beta=before.beta is not None,
        left_out=max(0, len(after.sensors) - MOST_PANELS),
        residuals=residual_table(replace(after, residuals=before)),
        gain=gain_view(document, found, report.session, report.calibration, after) if findings else None,
        limits=limits_view(document["limits"]),
        notes=tuple(document["notes"]),
    )


def _headline(otherwise: str, findings: Sequence[FindingView]) -> str:
    """The sentence of the first cause, or the choice that cannot be made."""
    if not findings:
        return otherwise
    first = findings[0]
    if not first.doubtful:
        return first.sentence
    names = [in_words(choice.cause) for choice in first.choices]
    who = f" ({', '.join(first.sensors)})" if first.sensors else ""
    return f"Cannot tell which: {listed(names)}{who}"


def _what_to_do(state: DiagnosisState, findings: Sequence[FindingView]) -> str:
    match state:
        case DiagnosisState.NAMED:
            return findings[0].advice
        case DiagnosisState.UNDECIDED:
            return CHOOSE
        case DiagnosisState.UNEXPLAINED:
            return UNKNOWN
        case _:
            return SOUND


def _structures(structures: Sequence[dict[str, Any]]) -> tuple[StructureView, ...]:
    return tuple(
        StructureView(
            where=s["where"],
            who=", ".join(s["sensors"]) or "all sensors together",
            evidence=f"{number(s['strength'], 1)} standard errors; {chance(s['p_value'])}",
        )
        for s in structures
    )


def _revision(revision: ModelRevision, session: StoredSession, known: Sequence[ModelRevision]) -> RevisionView:
    withdrawn = next((r for r in known if r.withdraws == revision.id), None)
    holds = revision.id <= session.revision and not (withdrawn and withdrawn.id <= session.revision)
    state = "calibrated with it" if holds else "calibrated without it" if withdrawn else "calibrated before it"
    return RevisionView(
        revision, cause_on(revision.cause, revision.sensors), f"{revision.scope} {revision.subject}", state, withdrawn
    )


def _scopes(session: StoredSession) -> tuple[tuple[str, str], ...]:
    """Whose model a cause can be accepted into."""
    units = ((Scope.UNIT.value, f"this unit, {session.unit}"), (Scope.UNIT_TYPE.value, "all units of its type"))
    return units if session.stand is None else (*units, (Scope.STAND.value, f"the stand, {session.stand}"))
