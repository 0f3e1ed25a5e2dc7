"""The page of a diagnosis, "What the simulation gets wrong": the cause and what to do first, then the evidence."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from estimator.causes import find
from estimator.diagnosis.results import Structure
from estimator.session import CALIBRATIONS
from service.charts import ChartSet
from service.charts.diagnosis import MOST_PANELS, Sides, diagnosis_charts
from service.charts.noise import noise_of
from service.judging.model_in_force import in_force
from service.pages.course import CourseView, course_views
from service.pages.diagnosis_line import PENDING, TONES
from service.pages.gain import GainView, gain_view
from service.pages.residual_table import ResidualTable, residual_table
from service.records.diagnosis import Diagnosed, DiagnosisReport, DiagnosisState, StoredDiagnosis
from service.records.model import ModelRevision, Scope
from service.records.session import StoredSession
from service.words.causes import cause_on
from service.words.diagnosis import HEADLINES, errors_of, headline, what_to_do
from service.words.finding import FindingView, evidence, finding_view
from service.words.fit import bands_in_words
from service.words.limits import BlindCauses, SeenCause, blind_causes, seen_causes
from service.words.structures import where_of, who_of

WAIT = "A large session takes some seconds; this page reads itself again."
CLAIM = "conditional-pass"
"""Tone where nothing is wrong but the standard errors that the file states, or only what the model always holds."""


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
class EvidenceView:
    """What a diagnosis rests on: absent while it is pending, and where none could be made."""

    wrong_errors: tuple[str, ...]
    """Which stated standard errors the readings contradict, a sentence each; empty where the headline says it."""
    findings: tuple[FindingView, ...]
    structures: tuple[StructureView, ...]
    courses: tuple[CourseView, ...]
    """Of the applied vector."""
    charts: tuple[ChartSet, ...]
    bands: str
    """What is drawn of the noise."""
    beta: bool
    """Whether the session has angles and runs of a stand."""
    left_out: int
    """Sensors that are not drawn."""
    residuals: ResidualTable
    gain: GainView | None
    """None where no cause is named."""
    seen: tuple[SeenCause, ...]
    blind: tuple[BlindCauses, ...]
    notes: tuple[str, ...]


FOLLOW = 3
"""Seconds: the page itself waits for a while."""


@dataclass(frozen=True)
class DiagnosisPage:
    """Everything the page shows."""

    session: StoredSession
    tone: str
    headline: str
    what_to_do: str
    follow: int | None
    """Seconds after which the page looks again while it is pending."""
    evidence: EvidenceView | None
    revisions: tuple[RevisionView, ...]
    scopes: tuple[tuple[str, str], ...]
    made: str


def diagnosis_page(report: DiagnosisReport) -> DiagnosisPage:
    """The page of a session's diagnosis, pending or made."""
    made, session = report.diagnosis, report.session
    pending = DiagnosisPage(
        session=session,
        tone="none",
        headline=PENDING,
        what_to_do=WAIT,
        follow=FOLLOW,
        evidence=None,
        revisions=tuple(_revision(r, session, report.revisions) for r in report.revisions if r.withdraws is None),
        scopes=_scopes(session),
        made="",
    )
    return pending if made is None else _made(pending, report, made)


def _made(pending: DiagnosisPage, report: DiagnosisReport, made: StoredDiagnosis) -> DiagnosisPage:
    found = made.found
    return replace(
        pending,
        tone=TONES[made.state] if found is None else _tone(made.state, found),
        headline=HEADLINES[made.state] if found is None else headline(found),
        what_to_do=made.summary if found is None else what_to_do(found),
        follow=None,
        evidence=None if found is None else _evidence(report, made, found),
        made=f"Made by estimator {made.estimator_version}",
    )


def _tone(state: DiagnosisState, found: Diagnosed) -> str:
    """Wrong standard errors are not all well, though nothing else is wrong; what the model always holds is no alarm."""
    known = [find(finding.cause) for finding in found.findings]
    is_held = state is DiagnosisState.NAMED and all(cause is not None and cause.always_modelled for cause in known)
    return CLAIM if is_held or (state is DiagnosisState.NOTHING and found.noise) else TONES[state]


def _evidence(report: DiagnosisReport, made: StoredDiagnosis, found: Diagnosed) -> EvidenceView:
    before, after, is_named = found.residuals_before, found.calibration, bool(found.findings)
    places = (*(f.sensors for f in found.findings), *(structure.sensors for structure in found.structures))
    named = [sensor for sensors in places for sensor in sensors]
    verdicts, noise = (report.session.verdict, made.verdict_after), noise_of(before, after)
    return EvidenceView(
        wrong_errors=errors_of(found) if is_named or found.structures else (),
        findings=_findings(report, found),
        structures=tuple(map(_structure, found.structures)),
        courses=course_views(found.structures, before),
        charts=diagnosis_charts(Sides(after.sensors, before, after.residuals if is_named else None, noise), named),
        bands=bands_in_words(after, noise.times),
        beta=before.beta is not None,
        left_out=max(0, len(after.sensors) - MOST_PANELS),
        residuals=residual_table(replace(after, residuals=before)),
        gain=gain_view(found.gain, report.calibration, after, *verdicts) if is_named else None,
        seen=seen_causes(found.limits, {sensor.kind for sensor in after.sensors}),
        blind=blind_causes(found.limits),
        notes=found.notes,
    )


def _findings(report: DiagnosisReport, found: Diagnosed) -> tuple[FindingView, ...]:
    revisions, is_stated = in_force(report.revisions), found.calibration.fit.noise == "stated" and not found.noise
    is_claim = is_stated and report.session.programme in CALIBRATIONS  # an alignment takes its turns' own scatter
    return tuple(finding_view(f, revisions, found.findings, by_stated_noise=is_claim) for f in found.findings)


def _structure(structure: Structure) -> StructureView:
    return StructureView(
        where=where_of(structure),
        who=who_of(structure),
        evidence=evidence(structure.strength, structure.p_value),
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
