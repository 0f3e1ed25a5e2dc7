"""Step: a verdict and what was found about its session → what the verdict is said with.

The verdict in force is one of several: of the baseline, of the model with the named causes, and of the model with each
alternative that the readings leave standing. Where they agree, and nothing that was found is large beside a tolerance,
it is plain.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

from estimator.diagnosis import Finding
from estimator.diagnosis.results import NoiseScale, Structure
from service.judging.cause_sizes import Size, Yardstick, size_of_cause, size_of_structure
from service.judging.standing import Otherwise, acts_within, is_of_record
from service.judging.temperatures import Covered
from service.judging.words import (
    ADD,
    CORRECT,
    FAILED,
    REPEAT,
    REPORT,
    RESTATE,
    TOO_FEW,
    advice_on,
    advice_on_structure,
    at_about,
    elsewhere,
    named,
    otherwise,
    size_in_words,
    unexplained,
    within,
    worth_in,
)
from service.kit.measures import COVERAGE
from service.sessions.decision import Verdict
from service.sessions.doubt import DoubtKind as Doubt
from service.sessions.doubt import Reservation
from service.sessions.words.noise_claims import wrong_errors

WORTH_SAYING = 1 / 3
"""Part of a tolerance from which on an effect is told: what a measurement may leave uncertain of it at most, too."""
Known = frozenset[tuple[str, str]]
"""Causes that are in the model in force, with the sensor or an empty name."""

UNCHECKED = (Reservation(Doubt.NOT_CHECKED, FAILED, REPORT),)
"""Of a session that could not be diagnosed."""


@dataclass(frozen=True, eq=False)
class Doubted:
    """What was found about a session, beside the verdict that it has."""

    verdict: Verdict | None
    """In force; None of a reference, or where nothing was judged."""
    findings: tuple[Finding, ...]
    structures: tuple[Structure, ...]
    noise: tuple[NoiseScale, ...]
    by: Yardstick
    otherwise: tuple[Otherwise, ...]
    """Verdicts under the other models that are left standing."""
    known: Known = frozenset()
    temperatures: Covered | None = None
    """Beside those of its unit; None where nothing says them, or nothing was judged."""
    worth: tuple[Size, ...] | None = None
    """What the step in temperature is worth in every parameter; None where that is not known."""


def reservations_of(session: Doubted) -> tuple[Reservation, ...]:
    """Everything that the verdict is said with, by how much it matters; empty where it is plain."""
    found = (
        *_of_temperature(session),
        *_of_findings(session),
        *_of_models(session),
        *_of_structures(session),
        *_of_errors(session),
        *_of_readings(session),
    )
    return tuple(sorted(found, key=lambda one: (list(Doubt).index(one.kind), -(one.share or 0.0))))


def _of_findings(session: Doubted) -> Iterator[Reservation]:
    """Record errors always, and causes that are large. What moved since earlier sessions is what the tolerances judge,
    and what is in the model already is taken care of."""
    for finding in session.findings:
        of_record = is_of_record(finding.cause)
        size = None if of_record or not acts_within(finding.cause) else size_of_cause(finding, session.by)
        if of_record or (_is_large(size) and not _is_known(finding, session.known)):
            kind, text = Doubt.RECORD if of_record else Doubt.CAUSE, named(finding, _in_words(size))
            plain = Reservation(kind, text, advice_on(finding.cause), finding.sensors, finding.cause)
            yield _sized(plain, size)


def _of_temperature(session: Doubted) -> Iterator[Reservation]:
    """Where the session lies outside what its unit covers, unless that is known to be worth little."""
    seen = session.temperatures
    if seen is None or not seen.is_far:
        return
    worth = None if session.worth is None else max(session.worth, key=_at_most)
    if worth is not None and _at_most(worth) <= WORTH_SAYING:
        return
    known = "" if worth is None else worth_in(worth.parameter, worth.sensors[0], _in_words(worth))
    text = elsewhere(seen.outside, seen.now, (seen.lowest, seen.highest), known)
    sensors = () if worth is None else worth.sensors
    yield _sized(Reservation(Doubt.TEMPERATURE, text, at_about(seen.reference), sensors), worth)


def _at_most(size: Size) -> float:
    """Of the tolerance, with U."""
    return (size.value + COVERAGE * (size.sigma or 0.0)) / size.tolerance


def _is_large(size: Size | None) -> bool:
    return size is not None and size.share > WORTH_SAYING


def _is_known(finding: Finding, known: Known) -> bool:
    return all((finding.cause, sensor) in known for sensor in finding.sensors or ("",))


def _of_models(session: Doubted) -> Iterator[Reservation]:
    """Each other verdict once, the worst first."""
    told: set[Verdict] = {session.verdict} if session.verdict is not None else set(Verdict)
    for other in sorted(session.otherwise, key=lambda one: -one.verdict.severity):
        if other.verdict not in told:
            told.add(other.verdict)
            text = otherwise(other.verdict, other.causes, other.sensors, named=other.named)
            yield Reservation(Doubt.OTHER_MODEL, text, REPEAT, other.sensors, verdict=other.verdict)


def _of_structures(session: Doubted) -> Iterator[Reservation]:
    """The one that speaks of the record, and else the largest."""
    record = [s for s in session.structures if s.of_record]
    if record:
        yield Reservation(Doubt.RECORD, unexplained(record, ""), CORRECT)
        return
    sized = ((s, size_of_structure(s, session.by)) for s in session.structures)
    large = [(s, size) for s, size in sized if size is not None and _is_large(size)]
    if large:
        first, size = max(large, key=lambda pair: pair[1].share)
        text = unexplained((first,), _in_words(size))
        yield _sized(Reservation(Doubt.UNEXPLAINED, text, advice_on_structure(first), first.sensors), size)


def _of_errors(session: Doubted) -> Iterator[Reservation]:
    """Errors stated too large only make a verdict plainer, so they are told where one is in doubt."""
    in_doubt = session.verdict not in (None, Verdict.PASS, Verdict.FAIL)
    wrong = (scale for scale in session.noise if scale.factor > 1 or in_doubt)
    kinds = {sensor.kind for sensor in session.by.calibration.sensors}
    for scale in wrong:
        [sentence] = wrong_errors((scale,), kinds)
        yield Reservation(Doubt.STATED_ERRORS, within(sentence), RESTATE, scale.sensors)


def _of_readings(session: Doubted) -> Iterable[Reservation]:
    """Nothing is left over to look for causes in."""
    exact = session.by.calibration.fit.is_exact and not session.findings
    return (Reservation(Doubt.NOT_CHECKED, TOO_FEW, ADD),) if exact else ()


def _in_words(size: Size | None) -> str:
    return "" if size is None else size_in_words(size.kind, size.parameter, (size.value, size.sigma), size.tolerance)


def _sized(plain: Reservation, size: Size | None) -> Reservation:
    """The reservation with the size that it rests on."""
    if size is None:
        return plain
    return replace(plain, parameter=size.parameter, size=size.value, uncertainty=size.sigma, share=size.share)
