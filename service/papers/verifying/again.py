"""Step: a session's file, and what its certificate states beside → all that the certificate states, computed again."""

from dataclasses import replace
from datetime import UTC, datetime

from estimator.health import judge
from estimator.health.parity import judge_parity
from estimator.message import joined
from estimator.session import IN_SERVICE
from service.ingest.checked import Checked, as_checked, check
from service.judging.calibrate import Calibrated, CalibrationBasis, calibrate
from service.judging.fault_words import faults_in_words
from service.judging.judge import as_decisions
from service.judging.words import by_defaults, first_in_words, reason, recording_in_words
from service.papers.certified import ReferenceSession, SessionReport, StatedSession
from service.papers.dcc.elements import plain
from service.papers.dcc.inputs import RecomputationInputs
from service.papers.verifying.records import RawFile
from service.papers.verifying.stated import Printed
from service.papers.words import traceability
from service.sessions.decision import Decision, Judged, Opening, ServiceFault
from service.sessions.records import ID_DIGITS, StoredSession
from service.sessions.words.advice import too_few
from service.sessions.words.conditions import condition_of


def stated_again(raw: RawFile, inputs: RecomputationInputs, printed: Printed, now: datetime) -> StatedSession:
    """The contents that the certificate should have; SessionError where the file cannot be read, ValueError where the
    contents of the certificate cannot be.
    """
    known = _checked(raw, printed, now)
    reference = inputs.reference
    compared_with = reference.calibration if reference and known.session.programme == IN_SERVICE else None
    found = calibrate(known, CalibrationBasis(inputs.model, compared_with))
    decisions = _decisions(found, inputs)
    session = _record(raw, found, inputs, decisions, printed)
    return StatedSession(
        report=SessionReport(session, found.calibration, decisions),
        source=known.session,
        type_name=printed.unit_type,
        reference=reference,
        said=_said(session, printed),
        finding=printed.declared("Diagnosis"),
        laboratory=printed.laboratory,
        customer=printed.customer,
        traceability=traceability(known.stand, inputs.stand_certificate, known.measured_at.date()),
        software=printed.version,
        temperatures=inputs.temperatures,
    )


def with_reference(
    inputs: RecomputationInputs, reference: ReferenceSession, file: RawFile, now: datetime
) -> RecomputationInputs:
    """The inputs with the reference's calibration computed again from its file."""
    new = check(file.content, file.name, now, lambda _: True)
    found = calibrate(new, CalibrationBasis(reference.model, None))
    return replace(inputs, reference=replace(reference, calibration=found.calibration))


def _checked(raw: RawFile, printed: Printed, now: datetime) -> Checked:
    """The session checked as at its upload. A file without a date takes the day of the certificate; where an earlier
    release issued it, this is a day of UTC.
    """
    new = check(raw.content, raw.name, now, lambda serial: serial == printed.serial)
    if new.session.started_at is None:
        return as_checked(new.session, printed.measured_on, new.session.unit)
    in_utc = new.measured_at.astimezone(UTC)
    return replace(new, measured_at=in_utc) if printed.measured_on.date() == in_utc.date() else new


def _decisions(found: Calibrated, inputs: RecomputationInputs) -> tuple[Decision, ...]:
    limits = {(kind, parameter): tolerance for kind, parameter, tolerance in inputs.tolerances}
    k, beside = inputs.coverage_factor, found.comparison
    if beside is not None:
        return as_decisions(judge_parity(beside.result, beside.reference, limits, coverage_factor=k), inputs.rule)
    reference = None if inputs.reference is None else inputs.reference.calibration
    steps = {(sensor, parameter): step for sensor, parameter, step in inputs.laws}
    return as_decisions(judge(found.calibration, reference, limits, coverage_factor=k, steps=steps), inputs.rule)


def _record(
    raw: RawFile, found: Calibrated, inputs: RecomputationInputs, decisions: tuple[Decision, ...], printed: Printed
) -> StoredSession:
    source = found.checked.session
    faults = _faults(found)
    why = (
        _opening(found, printed) if inputs.is_reference else _with_defaults(_reason(found, decisions, faults), printed)
    )
    judged = Judged(found.calibration, decisions, why, is_reference=inputs.is_reference, faults=faults)
    return StoredSession(
        id=raw.sha256[:ID_DIGITS],
        unit=source.unit,
        sha256=raw.sha256,
        filename=raw.name,
        size=len(raw.content),
        programme=source.programme,
        stand=found.checked.stand,
        operator=source.operator,
        notes=source.notes,
        started_at=found.checked.measured_at,
        uploaded_at=found.checked.measured_at,
        verdict=judged.verdict,
        reason=why,
        is_reference=inputs.is_reference,
        simulated=source.is_simulated,
        revision=inputs.model.revision,
    )


def _faults(found: Calibrated) -> tuple[ServiceFault, ...]:
    beside = found.comparison
    return () if beside is None else faults_in_words(beside.result, beside.started_at)


def _reason(found: Calibrated, decisions: tuple[Decision, ...], faults: tuple[ServiceFault, ...]) -> str:
    if found.comparison is not None:
        return recording_in_words(found.comparison.result, decisions, faults)
    return reason(decisions, too_few(found.calibration))


def _with_defaults(why: str, printed: Printed) -> str:
    """The reason in the words of the printed certificate: the file does not tell who set the tolerances."""
    by_nobody = joined(" ", (why, by_defaults(printed.unit_type)))
    return by_nobody if printed.declared("Verdict").endswith(plain(by_nobody)) else why


def _opening(found: Calibrated, printed: Printed) -> str:
    """The statement on a reference in the words of the printed certificate: the file does not tell how the session
    became one.
    """
    said = printed.declared("Verdict")
    ways = [first_in_words(found.calibration, opening) for opening in Opening]
    return next((opening for opening in ways if said.endswith(opening)), ways[0])


def _said(session: StoredSession, printed: Printed) -> str:
    """The verdict with its reservations, which rest on more than the file: as printed, if of this verdict."""
    word = condition_of(session.verdict, is_reference=session.is_reference).word
    said = printed.declared("Verdict").removesuffix(f". {plain(session.reason)}")
    return said if said.startswith(word) else word
