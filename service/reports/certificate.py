"""The certificate of a session, on paper: what a technician signs."""

from dataclasses import dataclass, replace
from math import degrees

from estimator.applied_vector import gravity
from estimator.health.rule import RULE
from estimator.session import ACCELEROMETER, IN_SERVICE, CalibrationSession
from service.charts import ChartSet
from service.charts.history import history_charts
from service.charts.residuals import residual_charts
from service.charts.tracks import tracks_of
from service.measures import COVERAGE, THIN, number, size_in_words
from service.records.decision import Decision
from service.records.diagnosis import StoredDiagnosis
from service.records.session import StoredSession
from service.reports.moved import Moved, moved
from service.reports.pictures import picture
from service.reports.results import ResultTable, result_tables
from service.reports.typeset import typeset
from service.views.certificate import CertifiedSession
from service.views.found_and_left import FoundAndLeft
from service.words.causes import cause_on
from service.words.conditions import CONDITIONS, Condition, condition_of
from service.words.finding import FindingView, finding_view
from service.words.fit import FitWords, fit_in_words
from service.words.known import combination_in_words
from service.words.motion import motions_in_words
from service.words.names import day_of, method_name, spaced
from service.words.verdict import margin_of

MOST_HISTORIES = 6
"""Histories that are drawn, of the parameters closest to their tolerance."""
MOST_RESIDUALS = 12
"""Panels of residuals that are drawn, the first of them; the session's page has all."""
WIDTH = 235
"""Of one drawn panel, pixels."""


@dataclass(frozen=True)
class Fact:
    """One line of what was measured, with what, by whom."""

    name: str
    value: str


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


@dataclass(frozen=True)
class Drawing:
    """One panel of a chart."""

    title: str
    text: str
    svg: str


@dataclass(frozen=True)
class Both:
    """One parameter as found and as left."""

    found: Moved
    left: Moved | None


@dataclass(frozen=True)
class Pair:
    """The unit before and after it was worked on, against the reference that held before."""

    found: str
    """Session and date."""
    rows: tuple[Both, ...]


@dataclass(frozen=True)
class State:
    """One state of the decision rule, explained."""

    formal: str
    meaning: str
    key: str


@dataclass(frozen=True)
class Certificate:
    """Everything that the paper says."""

    title: str
    number: str
    unit: str
    day: str
    simulated: bool
    condition: Condition
    reason: str
    facts: tuple[Fact, ...]
    record: tuple[Fact, ...]
    """Input, method, model, software."""
    sha256: str
    notes: str
    coverage: str
    judged: bool
    """Whether there was a reference to judge it by, and a tolerance."""
    rule: str
    whole_level: bool
    """Whether a number counts as out of tolerance only if it is a change at the level of all of them."""
    states: tuple[State, ...]
    tables: tuple[ResultTable, ...]
    together: tuple[str, ...]
    """What all sensors did together since the reference."""
    stage: str
    """``as found``, ``as left``, or empty."""
    pair: Pair | None
    known: tuple[Fact, ...]
    """What is known of parameters that the session cannot tell apart."""
    diagnosis: str
    causes: tuple[Cause, ...]
    fit: FitWords
    histories: tuple[Drawing, ...]
    residuals: tuple[Drawing, ...]
    stand: bool
    software: str


def certificate_pdf(found: CertifiedSession) -> bytes:
    """The certificate as PDF; its date is the upload's, so that the same record gives the same bytes."""
    return typeset("certificate.typ", certificate(found), found.report.session.uploaded_at)


def certificate(found: CertifiedSession) -> Certificate:
    """What the paper says of a session."""
    session, calibration, decisions = found.report.session, found.report.calibration, found.report.decisions
    k = decisions[0].coverage_factor if decisions else COVERAGE
    known = ((s.name, combination_in_words(c, s.kind)) for s in calibration.sensors for c in s.known)
    return Certificate(
        title=title_of(session),
        number=session.id[:12],
        unit=session.unit,
        day=day_of(session.started_at),
        simulated=session.simulated,
        condition=condition_of(session.verdict, is_reference=session.is_reference),
        reason=session.reason,
        facts=tuple(_facts(found)),
        record=tuple(_record(found)),
        sha256=session.sha256,
        notes=session.notes,
        coverage=number(k),
        judged=bool(decisions) and not session.is_reference,
        rule=decisions[0].rule if decisions else "",
        whole_level=any(d.rule.startswith(RULE) for d in decisions),
        states=tuple(State(c.formal, c.meaning, c.key) for c in reversed(CONDITIONS)),
        tables=tuple(_with_reading_unit(t, found.source) for t in _tables(found, k)),
        together=tuple(line.text for line in motions_in_words(found.report.motions, k)),
        stage=spaced(session.stage or ""),
        pair=None if found.pair is None else _pair(found.pair),
        known=tuple(Fact(name, words) for name, words in known),
        diagnosis=found.diagnosis.summary,
        causes=_causes(found.diagnosis, found),
        fit=fit_in_words(calibration),
        histories=_histories(found),
        residuals=_residuals(found),
        stand=calibration.residuals.beta is not None,
        software=found.software,
    )


def title_of(session: StoredSession) -> str:
    """A recording in service checks a calibration; it is none."""
    return "Check in service" if session.programme == IN_SERVICE else "Calibration certificate"


def _tables(found: CertifiedSession, k: float) -> tuple[ResultTable, ...]:
    reference = None if found.reference is None else found.reference.calibration
    decisions = () if found.report.session.is_reference else found.report.decisions
    return result_tables(found.report.calibration, reference, decisions, k)


def _with_reading_unit(table: ResultTable, source: CalibrationSession) -> ResultTable:
    """``V per g`` where all its sensors are read in one unit."""
    units = {s.reading_unit for s in source.sensors if s.name in {row.sensor for row in table.rows}}
    if not table.value_measure.startswith("per ") or len(units) != 1:
        return table
    rate = "/s" if source.count_time and "°" in table.value_measure else ""
    return replace(table, value_measure=f"{units.pop()}{rate} {table.value_measure}")


def _facts(found: CertifiedSession) -> list[Fact]:
    """What was measured, with what, by whom."""
    session, source = found.report.session, found.source
    facts = [
        Fact("Unit", session.unit),
        Fact("Unit type", found.unit_type.name),
        Fact("Sensors", _sensors(source)),
        Fact("Programme", spaced(session.programme)),
        Fact("Measured", f"{day_of(session.started_at)}, {session.started_at:%H:%M} UTC"),
        Fact("Operator", session.operator or "not stated"),
        Fact("Stand", _stand(source)),
        Fact("Site", _site(source)),
        Fact("Judged against", _judged_against(found)),
        Fact("State of the unit", _state(found)),
    ]
    temperature = _temperature(source)
    return [*facts, Fact("Temperature", temperature)] if temperature else facts


def _sensors(source: CalibrationSession) -> str:
    kinds = [s.kind for s in source.sensors]
    return ", ".join(f"{kinds.count(k)} {k}{'s' if kinds.count(k) > 1 else ''}" for k in dict.fromkeys(kinds))


def _stand(source: CalibrationSession) -> str:
    if source.stand is None:
        return "none"
    angles = (("α", source.stand.alpha), ("χ", source.stand.chi))
    stated = (f"{name} = {number(degrees(angle))}°" for name, angle in angles if angle is not None)
    return ", ".join([source.stand.id, *stated])


def _site(source: CalibrationSession) -> str:
    site, parts = source.site, []
    if site.latitude is not None:
        parts.append(f"latitude {number(degrees(site.latitude), 4)}°, height {number(site.height)}{THIN}m")
    if any(s.kind == ACCELEROMETER for s in source.sensors):
        stated = "measured" if site.gravity is not None else "by formula"
        parts.append(f"g = {number(gravity(site), 6)}{THIN}m/s² ({stated})")
    return ", ".join(parts) or "not stated"


def _temperature(source: CalibrationSession) -> str:
    if source.temperature is None:
        return ""
    low, high = float(source.temperature.min()), float(source.temperature.max())
    return f"{number(low, 1)} to {number(high, 1)}{THIN}°C" if high - low > 0.05 else f"{number(low, 1)}{THIN}°C"


def _judged_against(found: CertifiedSession) -> str:
    if found.reference is not None:
        other = found.reference.session
        return f"session {other.id[:12]} of {day_of(other.started_at)}"
    return "nothing: it is the reference of later sessions" if found.report.session.is_reference else "no reference"


def _state(found: CertifiedSession) -> str:
    """As found or as left, and what was last done to the unit."""
    last = f"last service: {found.services[-1].kind}, {day_of(found.services[-1].at)}" if found.services else ""
    stated = [part for part in (spaced(found.report.session.stage or ""), last) if part]
    return ", ".join(stated) or "no service recorded"


def _pair(pair: FoundAndLeft) -> Pair:
    rows = (Both(moved(before), None if after is None else moved(after)) for before, after in pair.decisions)
    return Pair(f"session {pair.found.id[:12]} of {day_of(pair.found.started_at)}", tuple(rows))


def _record(found: CertifiedSession) -> list[Fact]:
    session = found.report.session
    causes = (cause_on(r.cause, r.sensors) for r in found.revisions)
    model = f"revision {session.revision}: baseline with {', '.join(causes)}" if session.revision else "baseline (0)"
    return [
        Fact("Input file", f"{session.filename}, {size_in_words(session.size)}"),
        Fact("Uploaded", f"{day_of(session.uploaded_at)}, {session.uploaded_at:%H:%M} UTC"),
        Fact("Method", method_name(found.report.calibration.method)),
        Fact("Model revision", model),
        Fact("Session", session.id),
        Fact("Software", f"imu-health {found.software}"),
    ]


def _causes(diagnosis: StoredDiagnosis, found: CertifiedSession) -> tuple[Cause, ...]:
    findings = () if diagnosis.found is None else diagnosis.found.findings
    views = (finding_view(finding, found.revisions) for finding in findings)
    return tuple(
        Cause(
            sentence=view.sentence,
            amplitudes="; ".join(part for part in (*view.amplitudes, view.shape) if part),
            evidence=view.evidence,
            alternatives=", ".join(choice.name for choice in view.choices),
            corrected=_corrected(view),
        )
        for view in views
    )


def _corrected(view: FindingView) -> str:
    if view.accepted:
        return f"Taken into account by model revision {max(view.accepted)}."
    return "Not taken into account by the numbers of this certificate." if view.acceptable else ""


def _histories(found: CertifiedSession) -> tuple[Drawing, ...]:
    """The parameters closest to their tolerance, through time."""
    closest = sorted(found.report.decisions, key=_rank)[:MOST_HISTORIES]
    wanted = [(d.parameter, d.sensor) for d in closest if margin_of(d) is not None]
    drawn: dict[tuple[str, str], Drawing] = {}
    for tracks in tracks_of(found.history, found.services):
        charts = history_charts(tracks, found.services)
        drawn |= {
            (track.parameter, track.sensor): _drawing(charts, place, f"{track.sensor} {spaced(track.parameter)}")
            for place, track in enumerate(tracks)
            if (track.parameter, track.sensor) in wanted and len(track.points) > 1
        }
    return tuple(drawn[key] for key in wanted if key in drawn)


def _rank(decision: Decision) -> float:
    margin = margin_of(decision)
    return float("inf") if margin is None else margin


def _residuals(found: CertifiedSession) -> tuple[Drawing, ...]:
    """By the angle of the head where there was a stand, else in the order measured."""
    sets = residual_charts(found.report.calibration)
    across = {charts.name.rpartition("-")[2] for charts in sets}
    wanted = "beta" if "beta" in across else "order"
    shown = [(charts, place) for charts in sets if charts.name.endswith(wanted) for place in range(len(charts.panels))]
    return tuple(_drawing(charts, place, charts.panels[place].title) for charts, place in shown[:MOST_RESIDUALS])


def _drawing(charts: ChartSet, place: int, title: str) -> Drawing:
    panel = charts.panels[place]
    return Drawing(title, panel.description, picture(charts, panel, WIDTH))
