"""Facts of a measurement: object, equipment, operator, conditions, and input data."""

from dataclasses import dataclass
from math import degrees

from estimator.applied_vector import gravity
from estimator.message import joined, say
from estimator.session import ACCELEROMETER, CalibrationSession
from estimator.wording import counted
from service.diagnosis.words.causes import cause_on
from service.diagnosis.words.findings import FindingView, finding_view
from service.judging.temperature_words import covered_in_words, span_in_words
from service.kit.measures import THIN, day_of, method_name, minute_of, number, size_in_words, spaced
from service.papers.certified import CertifiedSession
from service.papers.words import stated
from service.sessions.words.readings import switched_on


@dataclass(frozen=True)
class Fact:
    """A name and its value."""

    name: str
    value: str
    is_written: bool = False
    """Whether the value is a name or text written by people: it is the same in every language."""


@dataclass(frozen=True)
class CertifiedCause:
    """A named cause of errors of the simulation."""

    sentence: str
    amplitudes: str
    evidence: str
    alternatives: str
    """Causes that this session cannot distinguish from it."""
    corrected: str
    """Whether the calibration takes it into account; empty for a cause that cannot be part of a model."""


def causes_of(found: CertifiedSession) -> tuple[CertifiedCause, ...]:
    """The findings of the diagnosis, in order; empty without a diagnosis."""
    diagnosis = found.diagnosis.found
    findings = () if diagnosis is None else diagnosis.findings
    views = (finding_view(finding, found.revisions, findings) for finding in findings)
    return tuple(
        CertifiedCause(
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


def facts_of(found: CertifiedSession) -> tuple[Fact, ...]:
    """Object, equipment, operator and conditions of the measurement."""
    session, source = found.report.session, found.source
    return (
        Fact("Unit", session.unit, is_written=True),
        Fact("Unit type", found.unit_type.name, is_written=True),
        Fact("Sensors", _sensors(source)),
        Fact("Programme", spaced(session.programme)),
        Fact(
            "Method",
            say(
                "{method}, version {software}",
                method=method_name(found.report.calibration.method),
                software=found.software,
            ),
        ),
        Fact("Measured", _measured(found)),
        Fact("Operator", stated(session.operator), is_written=bool(session.operator)),
        Fact("Stand", _stand(source), is_written=source.stand is not None),
        Fact("Site", _site(source)),
        Fact("Judged against", _judged_against(found)),
        Fact("State of the unit", _state(found)),
        Fact("Temperature", span_in_words(source.temperature)),
        Fact("Temperatures covered", covered_in_words(found.temperatures)),
        *([Fact("Switched on", on)] if (on := switched_on(session.time_since_power_on)) else ()),
    )


def _measured(found: CertifiedSession) -> str:
    if found.source.started_at is None:
        return "day not stated; see the upload under Record"
    at = found.report.session.started_at
    return minute_of(at)


def _sensors(source: CalibrationSession) -> str:
    kinds = [s.kind for s in source.sensors]
    return joined(", ", (counted(kinds.count(k), k) for k in dict.fromkeys(kinds)))


def _stand(source: CalibrationSession) -> str:
    if source.stand is None:
        return "none"
    angles = (("α", source.stand.alpha), ("χ", source.stand.chi))
    set_to = (f"{name} = {number(degrees(angle))}°" for name, angle in angles if angle is not None)
    return joined(", ", [source.stand.id, *set_to])


def _site(source: CalibrationSession) -> str:
    site, parts = source.site, list[str]()
    if site.latitude is not None:
        parts.append(
            say(
                "latitude {latitude}°, height {height}{thin_space}m",
                latitude=number(degrees(site.latitude), 4),
                height=number(site.height),
                thin_space=THIN,
            )
        )
    if any(s.kind == ACCELEROMETER for s in source.sensors):
        origin = "measured" if site.gravity is not None else "by formula"
        parts.append(
            say("g = {size}{thin_space}m/s² ({origin})", size=number(gravity(site), 6), thin_space=THIN, origin=origin)
        )
    return joined(", ", parts) or stated("")


def _judged_against(found: CertifiedSession) -> str:
    if found.reference is not None:
        reference = found.reference
        return say("session {id} of {started_at}", id=reference.session[:12], started_at=day_of(reference.started_at))
    return "nothing: it is the reference of later sessions" if found.report.session.is_reference else "no reference"


def _state(found: CertifiedSession) -> str:
    """Stage of the session, as found or as left, and the last service of the unit."""
    last = (
        say("last service: {kind}, {date}", kind=found.services[-1].kind, date=day_of(found.services[-1].at))
        if found.services
        else ""
    )
    known = [part for part in (spaced(found.report.session.stage or ""), last) if part]
    return joined(", ", known) or "no service recorded"


def record_of(found: CertifiedSession) -> tuple[Fact, ...]:
    """Input, method, model, software."""
    session = found.report.session
    causes = (cause_on(r.cause, r.sensors) for r in found.revisions)
    model = (
        say("revision {revision}: baseline with {causes}", revision=session.revision, causes=joined(", ", causes))
        if session.revision
        else "baseline (0)"
    )
    return (
        Fact("Input file", say("{filename}, {size}", filename=session.filename, size=size_in_words(session.size))),
        Fact("Uploaded", minute_of(session.uploaded_at)),
        Fact("Model revision", model),
        Fact("Session", session.id),
        Fact("Software", f"imu-health {found.software}"),
    )
