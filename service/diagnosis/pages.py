"""The page of a diagnosis and its forms."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Annotated

from fastapi import APIRouter, Form, Path, Request
from fastapi.responses import HTMLResponse, RedirectResponse

from estimator.causes import find
from estimator.diagnosis.results import Structure
from estimator.message import say
from estimator.session import CALIBRATIONS
from service.diagnosis.charts import MOST_PANELS, Sides, diagnosis_charts
from service.diagnosis.gain import GainView, gain_view
from service.diagnosis.records import Diagnosed, DiagnosisReport, StoredDiagnosis
from service.diagnosis.sections import PENDING, TONES, CourseView, SharedView, course_views, shared_views
from service.diagnosis.words.causes import cause_on, weighty_first
from service.diagnosis.words.diagnosis import (
    HEADLINES,
    BlindCauses,
    SeenCause,
    blind_causes,
    errors_of,
    headline,
    seen_causes,
    what_to_do,
)
from service.diagnosis.words.findings import FindingView, evidence, finding_view, where_of, who_of
from service.diagnosis.words.gain import gain_in_words
from service.models.records import ModelRevision, NewModel, Scope
from service.models.rules import in_force
from service.models.store import Models
from service.pages.courses import changed_courses
from service.people.dependencies import SEE_OTHER, By, FormLines, FormText, Key, Why
from service.records.dependencies import ReceptionOf
from service.records.models import accept_model, withdraw_model
from service.records.recalibrate import recompute_beside
from service.sessions.calibrations_store import Calibrations
from service.sessions.charts import ChartSet, noise_of
from service.sessions.lines import ResidualTable, residual_table
from service.sessions.records import DiagnosisState, StoredSession
from service.sessions.store import Sessions
from service.sessions.words.readings import bands_in_words
from service.storage.queries import Store
from service.web.dependencies import Now, Reading
from service.web.render import render
from service.work.dependencies import ReaderOf
from service.work.readers import PAGE_PATIENCE

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
    """State of the cause in this session's calibration."""
    withdrawn: ModelRevision | None


@dataclass(frozen=True)
class EvidenceView:
    """Evidence of a diagnosis; absent while it is pending, and where none could be made."""

    wrong_errors: tuple[str, ...]
    """Stated standard errors that the readings contradict, a sentence each; empty where the headline says it."""
    findings: tuple[FindingView, ...]
    shared: tuple[SharedView | None, ...]
    """The course of every finding in turn, where its sensors share one."""
    structures: tuple[StructureView, ...]
    courses: tuple[CourseView, ...]
    """Courses of the applied vector."""
    charts: tuple[ChartSet, ...]
    bands: str
    """Explanation of the drawn bands of noise."""
    beta: bool
    """Whether the session has angles and runs of a stand."""
    left_out: int
    """Sensors that are not drawn."""
    residuals: ResidualTable
    gains: tuple[str, ...]
    """Gain of every finding in turn for its sensors, in one sentence."""
    is_seen: bool
    """Whether the named causes change what is measured minus simulated."""
    gain: GainView | None
    """Gain of the named causes; None where no cause is named, or where it has nothing to show."""
    seen: tuple[SeenCause, ...]
    blind: tuple[BlindCauses, ...]
    notes: tuple[str, ...]
    changed: tuple[ChartSet, ...]
    """Histories of the parameters that changed since earlier sessions."""


FOLLOW = 3
"""Seconds until the page looks again: the page itself waits for a while."""


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
    gain: str
    """Gain of all named causes, in one sentence."""


def diagnosis_page(report: DiagnosisReport, changed: tuple[ChartSet, ...] = ()) -> DiagnosisPage:
    """The page of a session's diagnosis, pending or made; ``changed`` are histories of what changed since earlier
    sessions."""
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
        gain="",
    )
    return pending if made is None else _made(pending, report, made, changed)


def _made(
    pending: DiagnosisPage, report: DiagnosisReport, made: StoredDiagnosis, changed: tuple[ChartSet, ...]
) -> DiagnosisPage:
    found = made.found
    return replace(
        pending,
        tone=TONES[made.state] if found is None else _tone(made.state, found),
        headline=HEADLINES[made.state] if found is None else headline(found),
        what_to_do=made.summary if found is None else what_to_do(found),
        follow=None,
        evidence=None if found is None else _evidence(report, made, found, changed),
        made=say("Made by estimator {estimator_version}", estimator_version=made.estimator_version),
        gain=made.gain_in_words,
    )


def _tone(state: DiagnosisState, found: Diagnosed) -> str:
    """Wrong standard errors are not all well, though nothing else is wrong; what the model always holds is no alarm."""
    known = [find(finding.cause) for finding in found.findings]
    is_held = state is DiagnosisState.NAMED and all(cause is not None and cause.always_modelled for cause in known)
    return CLAIM if is_held or (state is DiagnosisState.NOTHING and found.noise) else TONES[state]


def _evidence(
    report: DiagnosisReport, made: StoredDiagnosis, found: Diagnosed, changed: tuple[ChartSet, ...]
) -> EvidenceView:
    before, after, is_named = found.residuals_before, found.calibration, bool(found.findings)
    places = (*(f.sensors for f in found.findings), *(structure.sensors for structure in found.structures))
    named = [sensor for sensors in places for sensor in sensors]
    verdicts, noise = (report.session.verdict, made.verdict_after), noise_of(before, after)
    gain = gain_view(found.gain, report.calibration, after, *verdicts) if is_named else None
    is_seen = is_named and gain is not None and not gain.is_none
    return EvidenceView(
        wrong_errors=errors_of(found) if is_named or found.structures else (),
        findings=_findings(report, found),
        shared=shared_views(weighty_first(found.findings), after),
        structures=tuple(map(_structure, found.structures)),
        courses=course_views(found.structures, before),
        charts=diagnosis_charts(Sides(after.sensors, before, after.residuals if is_seen else None, noise), named),
        bands=bands_in_words(after, noise.times),
        beta=before.beta is not None,
        left_out=max(0, len(after.sensors) - MOST_PANELS),
        residuals=residual_table(replace(after, residuals=before)),
        gains=tuple(gain_in_words(found.gain, f.sensors) for f in found.findings),
        is_seen=is_seen,
        gain=None if gain is None or gain.shows_nothing else gain,
        seen=seen_causes(found.limits, {sensor.kind for sensor in after.sensors}),
        blind=blind_causes(found.limits),
        notes=found.notes,
        changed=changed,
    )


def _findings(report: DiagnosisReport, found: Diagnosed) -> tuple[FindingView, ...]:
    revisions, is_stated = in_force(report.revisions), found.calibration.fit.noise == "stated" and not found.noise
    is_claim = is_stated and report.session.programme in CALIBRATIONS  # an alignment takes its turns' own scatter
    return tuple(
        finding_view(f, revisions, found.findings, by_stated_noise=is_claim) for f in weighty_first(found.findings)
    )


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
        revision,
        cause_on(revision.cause, revision.sensors),
        say("{scope} {subject}", scope=revision.scope, subject=revision.subject),
        state,
        withdrawn,
    )


def _scopes(session: StoredSession) -> tuple[tuple[str, str], ...]:
    """Scopes of models into which a cause can be accepted, in words."""
    units = (
        (Scope.UNIT.value, say("this unit, {unit}", unit=session.unit)),
        (Scope.UNIT_TYPE.value, "all units of its type"),
    )
    return (
        units
        if session.stand is None
        else (*units, (Scope.STAND.value, say("the stand, {stand}", stand=session.stand)))
    )


def diagnosis_report(store: Store, id: str, diagnosis: StoredDiagnosis | None) -> DiagnosisReport:
    """The session, its diagnosis, its calibration in force and the model revisions that concern it."""
    return DiagnosisReport(
        Sessions(store).get(id), diagnosis, Calibrations(store).get(id), Models(store).of_session(id)
    )


router = APIRouter(include_in_schema=False)


@router.get("/sessions/{id}/diagnosis")
def show_diagnosis(request: Request, store: Reading, id: Key, reader: ReaderOf) -> HTMLResponse:
    """Shows the diagnosis of the session."""
    report = diagnosis_report(store, id, reader.read(id, patience=PAGE_PATIENCE))
    page = diagnosis_page(report, changed_courses(store, report))
    return render(request, "diagnosis.html", page)


@router.post("/sessions/{id}/diagnosis/accept")
def accept(
    id: Key,
    reception: ReceptionOf,
    reader: ReaderOf,
    now: Now,
    *,
    cause: FormText,
    scope: Annotated[Scope, Form()],
    by: By,
    note: FormLines = "",
) -> RedirectResponse:
    """Accepts a named cause, and shows its gain and the results for the stored sessions."""
    made = accept_model(reception.storage, reader.made(id), NewModel(cause, scope, by, note), now)
    recompute_beside(reception, now)
    return RedirectResponse(f"/models/{made.id}", SEE_OTHER)


@router.post("/sessions/{id}/diagnosis/withdraw/{revision}")
def withdraw(
    id: Key,
    revision: Annotated[int, Path(ge=1, le=2**31 - 1)],
    reception: ReceptionOf,
    now: Now,
    *,
    by: By,
    why: Why,
) -> RedirectResponse:
    """Takes an accepted cause out of the model again, and shows the models that concern the session."""
    withdraw_model(reception.storage, revision, by, why, now)
    recompute_beside(reception, now)
    return RedirectResponse(f"/sessions/{id}/diagnosis#models", SEE_OTHER)
